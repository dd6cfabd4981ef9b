"""Which runs stand side by side: what may differ, and what each has come to."""
