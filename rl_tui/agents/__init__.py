"""The agents: policies, algorithms, planners and their kernels."""
