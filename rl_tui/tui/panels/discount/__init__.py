"""What γ decides: Q*(γ), and where the optimal actions change."""
