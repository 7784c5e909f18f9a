"""What is done for the processor: explicit vectors, kept machine code, the same digits on every machine."""
