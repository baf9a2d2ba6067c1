from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Camera",
    "Cancelled",
    "Field",
    "Focus",
    "GpuAbsent",
    "Picture",
    "Scene",
    "__version__",
    "compare",
    "open",
    "read_picture",
    "report",
    "set_threads",
]

__version__: str
_UNWRAP_CHILD: str

_Path = str | PathLike[str]
_Progress = Callable[[float, str], object]
_Exposure = Literal["normalise", "conserve"]
_Floats = NDArray[np.float32]
_Over = Literal["atlas", "part", "triangle", "splat"]

class Cancelled(Exception): ...
class GpuAbsent(RuntimeError): ...

@final
class Camera:
    def __new__(
        cls,
        *,
        width: int = ...,
        height: int = ...,
        yfov: float = ...,
        focus_distance: float | Literal["inf"] = ...,
        aperture_radius: float = ...,
        sensor_height: float = ...,
        shift: ArrayLike = ...,
        camera_to_world: ArrayLike = ...,
        background: ArrayLike = ...,
        aperture: Mapping[str, Any] = ...,
        character: Mapping[str, Any] = ...,
    ) -> Camera: ...
    @staticmethod
    def read(file: _Path) -> Camera: ...
    def write(self, file: _Path) -> None: ...
    def replace(
        self,
        *,
        size: tuple[int, int] | None = None,
        width: int = ...,
        height: int = ...,
        yfov: float = ...,
        focus_distance: float | Literal["inf"] = ...,
        aperture_radius: float = ...,
        sensor_height: float = ...,
        shift: ArrayLike = ...,
        camera_to_world: ArrayLike = ...,
        background: ArrayLike = ...,
        aperture: Mapping[str, Any] = ...,
        character: Mapping[str, Any] = ...,
    ) -> Camera: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def yfov(self) -> float: ...
    @property
    def focus_distance(self) -> float: ...
    @property
    def aperture_radius(self) -> float: ...
    @property
    def sensor_height(self) -> float: ...
    @property
    def f_number(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Focus:
    @property
    def t(self) -> _Floats: ...
    @t.setter
    def t(self, value: ArrayLike) -> None: ...
    @property
    def anchor(self) -> _Floats: ...
    @anchor.setter
    def anchor(self, value: ArrayLike) -> None: ...
    @property
    def gloss(self) -> _Floats: ...
    @gloss.setter
    def gloss(self, value: ArrayLike) -> None: ...
    @property
    def background(self) -> tuple[float, float, float]: ...
    @background.setter
    def background(self, value: tuple[float, float, float]) -> None: ...
    @property
    def over(self) -> _Over: ...
    def sharpen(self) -> None: ...
    def select(self, mask: NDArray[np.bool_], camera: Camera | None = None) -> NDArray[np.bool_]: ...

@final
class Picture:
    @property
    def radiance(self) -> _Floats: ...
    @property
    def coverage(self) -> _Floats: ...
    @property
    def layers(self) -> dict[str, _Floats]: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def warnings(self) -> list[str]: ...
    def exposed(self, exposure: _Exposure | None = None) -> _Floats: ...
    def write(self, file: _Path, *, exposure: _Exposure | None = None) -> None: ...

@final
class Field:
    @property
    def camera(self) -> Camera: ...
    def render(
        self,
        focus: Focus | _Path | None = None,
        camera: Camera | None = None,
        *,
        progress: _Progress | None = None,
        renderer: Literal["splat", "scatter"] = ...,
        seed: int = ...,
        tolerance: float | None = ...,
        aov: Sequence[str] = ...,
        backend: Literal["cpu", "gpu", "auto"] = ...,
    ) -> Picture: ...
    def write(self, file: _Path) -> None: ...
    def samples(self) -> dict[str, NDArray[Any]]: ...
    def __len__(self) -> int: ...

@final
class Scene:
    @property
    def path(self) -> PathLike[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def camera(self) -> Camera: ...
    @property
    def cameras(self) -> list[str]: ...
    @property
    def parts(self) -> list[tuple[str, str]]: ...
    @property
    def triangles(self) -> int: ...
    def find_camera(self, name: _Path) -> Camera: ...
    def focus(
        self,
        file: _Path | None = None,
        *,
        over: _Over = "atlas",
        progress: _Progress | None = None,
    ) -> Focus: ...
    def bake(
        self,
        camera: Camera | None = None,
        focus: Focus | _Path | None = None,
        *,
        light_passes: int = 0,
        progress: _Progress | None = None,
    ) -> Field: ...
    def render(
        self,
        camera: Camera | None = None,
        focus: Focus | _Path | None = None,
        *,
        progress: _Progress | None = None,
        renderer: Literal["splat", "truth", "blur", "layers", "views", "scatter"] = ...,
        spp: int = ...,
        seed: int = ...,
        tolerance: float | None = ...,
        cells: int = ...,
        light_passes: int = ...,
        aov: Sequence[str] = ...,
        backend: Literal["cpu", "gpu", "auto"] = ...,
    ) -> Picture: ...
    def truth(
        self,
        camera: Camera | None = None,
        focus: Focus | _Path | None = None,
        *,
        spp: int = 256,
        seed: int = 0,
        progress: _Progress | None = None,
    ) -> Picture: ...

def open(
    path: _Path,
    *,
    variant: str | None = None,
    cache: _Path | None = None,
    progress: _Progress | None = None,
) -> Scene: ...
def compare(
    a: Picture | _Path | ArrayLike,
    b: Picture | _Path | ArrayLike,
    *,
    exposure: _Exposure | None = None,
) -> dict[str, float]: ...
def read_picture(file: _Path) -> _Floats: ...
def report(
    scenes: _Path | Sequence[_Path],
    folder: _Path,
    *,
    camera: _Path | None = None,
    focus: _Path | None = None,
    size: tuple[int, int] | None = None,
    spp: int | None = None,
    quick: bool = False,
    hard: bool = False,
    progress: _Progress | None = None,
) -> dict[str, Any]: ...
def set_threads(threads: int) -> None: ...
