"""The XML files of an FMU."""
