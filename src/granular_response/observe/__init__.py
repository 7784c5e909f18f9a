"""What is measured on states. Arrays in, arrays out; nothing here changes a state."""
