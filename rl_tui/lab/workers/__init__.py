"""Work done by processes of their own, asked for once and answered line by line."""
