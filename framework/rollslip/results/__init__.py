"""What a result is, how any is stored, drawn and told."""
