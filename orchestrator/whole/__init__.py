"""The system as one: model exchange, monolithic twin, linear model; a run held against it."""
