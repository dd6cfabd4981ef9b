"""Who learns: action rules, update rules, planners and their compiled kernels."""
