"""Printed reports: words and tables for people."""
