"""Exact solutions of a finite MDP and exact evaluation of any policy in it."""
