"""Exact solutions of finite MDPs, and exact evaluation of policies."""
