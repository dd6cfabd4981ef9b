"""The agents: policies, algorithms, planners and their compiled kernels."""
