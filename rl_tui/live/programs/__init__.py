"""Programs of other people on screen: what a playback is for our own runs."""
