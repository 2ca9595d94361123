"""What the compiled macro loops are made of: tables, and moves that masters share."""
