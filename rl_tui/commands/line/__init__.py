"""What every command uses: output, progress, the way to the screen."""
