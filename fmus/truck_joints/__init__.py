"""The truck of joints: five rigid bodies, whose reduction to six shapes the truck block is."""
