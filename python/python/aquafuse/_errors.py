"""The exceptions of this package. Each message says what is wrong, why, and what to do."""

__all__ = ["AquaFuseError", "ArgumentError", "ArrayError", "FileError", "InternalError", "RunError"]


class AquaFuseError(Exception):
    """What every exception of this package is."""


class ArgumentError(AquaFuseError, ValueError):
    """An option has a value that it cannot have."""


class ArrayError(ArgumentError):
    """An array or a tensor has a shape, a dtype or values that cannot be used."""


class FileError(AquaFuseError, OSError):
    """A file cannot be read or written."""


class RunError(AquaFuseError, RuntimeError):
    """A run over many files cannot begin, or part of it failed."""


class InternalError(AquaFuseError, RuntimeError):
    """A bug of aquafuse. The process and its data are intact."""
