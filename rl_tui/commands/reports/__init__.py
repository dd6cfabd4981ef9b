"""Printed reports for people."""
