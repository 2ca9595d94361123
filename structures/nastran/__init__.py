"""Nastran: bulk data as a model, modes of a punch file."""

from .bulk import Deck, read_bulk

__all__ = ["Deck", "read_bulk"]
