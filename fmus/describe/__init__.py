"""What blocks are described with: variables, blocks, terminals, parameters, units, twins."""
