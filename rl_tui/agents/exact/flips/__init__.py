"""Every γ at which the set of optimal actions changes, decided in exact rational arithmetic."""
