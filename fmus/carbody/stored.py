"""The carbody of a Python FMU: made of the modal data that stand beside this file there."""

from __future__ import annotations

from pathlib import Path

from .modal import ModalCarbody
from .modal_files import read_modal_data

BESIDE = "modal_data.toml"


def stored() -> ModalCarbody:
    """The block of the data."""
    return ModalCarbody(read_modal_data(Path(__file__).with_name(BESIDE)))
