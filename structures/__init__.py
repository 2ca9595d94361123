"""How a carbody's modes come about: finite elements, reduction, lading, and the modal survey.

Knows `fmus` by its modal data, and nothing of how FMUs are coupled. What reads or solves with a
further package (the extra `structures`) is a file of its own, imported where it is used.
"""
