"""What every room may use: errors and findings, words, limits, kiosk mode, interrupts, the random streams."""
