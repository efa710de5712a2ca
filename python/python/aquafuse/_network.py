"""Networks of depth from files."""

from __future__ import annotations

import os
from typing import Any, Literal, TypeAlias, final

from aquafuse import _native
from aquafuse._errors import FileError

NetworkKind: TypeAlias = Literal["inverse", "metric", "relative"]


@final
class DepthNetwork:
    """A network of depth from a file of ONNX, read once; pass it as ``depth_model``.

    ``depth_model="FILE.onnx"`` reads the file at each call; a network that was read is shared by all images. None is shipped or
    downloaded. What a network gives is refined by the image, and its numbers are those of ``aquafuse --depth-model FILE.onnx``.

    Args:
        path: The file, with its weights inside: one image of shape (1, 3, height, width) in, one map out.
        kind: What its numbers are: ``inverse`` (larger is nearer), ``metric`` (metres) or ``relative`` (larger is farther, 0 at
            the camera). By default the names of its inputs and outputs choose it.
        size: Images are scaled to about the area of a square of so many pixels a side, 14 to 4096, if the network takes any
            size. Default: 518.
        seconds: The longest that reading it, or one image, may take; a network that once took longer is refused from then on.
            Default: 600.

    Raises:
        FileError: The file cannot be read, is no such network, or its names do not settle what its numbers are.
        ArgumentError: There is no such kind.

    A network pickles as its path, so that worker processes read it too; a file that has changed is refused.

    >>> import aquafuse
    >>> aquafuse.DepthNetwork("missing.onnx")
    Traceback (most recent call last):
    ...
    aquafuse._errors.FileError: ...
    """

    __slots__ = ("_network",)
    _network: _native.DepthNetwork

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        kind: NetworkKind | None = None,
        size: int | None = None,
        seconds: int | None = None,
    ) -> None:
        self._network = _native.DepthNetwork(os.fspath(path), kind, size, seconds)

    @property
    def path(self) -> str:
        """Where it was read from."""
        return os.fspath(self._network.path)

    @property
    def kind(self) -> NetworkKind:
        """What its numbers are taken as."""
        return self._network.kind

    @property
    def size(self) -> int | None:
        """The side that was asked for."""
        return self._network.size

    @property
    def seconds(self) -> int | None:
        """The limit to its time that was asked for."""
        return self._network.seconds

    @property
    def sha256(self) -> str:
        """The SHA-256 of its file."""
        return self._network.sha256

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, DepthNetwork):
            return NotImplemented
        return (self.sha256, self.kind, self.size) == (other.sha256, other.kind, other.size)

    def __hash__(self) -> int:
        return hash((self.sha256, self.kind, self.size))

    def __reduce__(self) -> tuple[Any, ...]:
        return _read_again, (os.path.abspath(self.path), self.kind, self.size, self.seconds, self.sha256)

    def __repr__(self) -> str:
        return f"<DepthNetwork {self.path}: {self.kind}, sha256 {self.sha256[:12]}>"


def _read_again(path: str, kind: NetworkKind, size: int | None, seconds: int | None, sha256: str) -> DepthNetwork:
    network = DepthNetwork(path, kind=kind, size=size, seconds=seconds)
    if network.sha256 != sha256:
        raise FileError(f"{path} has changed since it was read as a depth model; make the object again")
    return network


DepthModel: TypeAlias = str | os.PathLike[str] | DepthNetwork


def shared_model(model: DepthModel) -> DepthModel:
    """The same model; a network that is named is read, once for all that use it."""
    is_named = not isinstance(model, DepthNetwork) and os.fspath(model).lower().endswith(".onnx")
    return DepthNetwork(model) if is_named else model  # type: ignore[arg-type]


def native_model(model: DepthModel) -> str | _native.DepthNetwork:
    """A depth model as the compiled part takes it."""
    return model._network if isinstance(model, DepthNetwork) else os.fspath(model)  # pyright: ignore[reportPrivateUsage]
