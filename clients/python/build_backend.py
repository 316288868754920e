"""Builds the package (PEP 517) with the standard library alone. The wheel contains the daemon's program and the C library of the
geometry: those beside $DELAUNAYD, or in build/ of the repository, or else compiled in a temporary directory. No files are left in
the source tree."""

from __future__ import annotations

import base64
import contextlib
import hashlib
import os
import re
import shutil
import subprocess
import sysconfig
import tempfile
import zipfile
from pathlib import Path
from typing import Any, List, Optional, Tuple

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
PACKAGE = "delaunayd"

with contextlib.suppress(OSError, TypeError, KeyError):  # this file's own bytecode
    os.remove(globals()["__cached__"])
    os.rmdir(os.path.dirname(globals()["__cached__"]))


def _field(name: str) -> str:
    found = re.search(r'^%s = "(.*)"$' % name, (HERE / "pyproject.toml").read_text(), re.M)
    assert found is not None
    return found.group(1)


VERSION = _field("version")
INFO = "%s-%s.dist-info" % (PACKAGE, VERSION)


def _metadata() -> bytes:
    lines = [
        "Metadata-Version: 2.1",
        "Name: " + PACKAGE,
        "Version: " + VERSION,
        "Summary: " + _field("description"),
        "License: MIT",
        "License-File: LICENSE",
        "Requires-Python: " + _field("requires-python"),
        "Provides-Extra: numpy",
        'Requires-Dist: numpy; extra == "numpy"',
        "Description-Content-Type: text/markdown",
        "",
        (HERE / "README.md").read_text(),
    ]
    return "\n".join(lines).encode()


# The content of the wheel besides Python: name in the wheel, target of make in a build folder, mode.
_BINARIES = (("bin/delaunayd", "delaunayd", 0o755), ("lib/libdelaunay-core.so.0", "lib/libdelaunay-core.so.0", 0o644))

_Files = List[Tuple[str, bytes, int]]  # name, content, mode


def _read(build: Path) -> _Files:
    return [("%s/%s" % (PACKAGE, name), (build / target).read_bytes(), mode) for name, target, mode in _BINARIES]


def _compile() -> Optional[_Files]:
    with tempfile.TemporaryDirectory() as scratch:
        targets = ["%s/%s" % (scratch, target) for _, target, _ in _BINARIES]
        command = ["make", "-s", "-j%d" % (os.cpu_count() or 1), "-C", str(REPOSITORY), "O=" + scratch, *targets]
        if not shutil.which("make") or not (REPOSITORY / "Makefile").is_file() or subprocess.call(command) != 0:
            return None
        return _read(Path(scratch))


def _binaries() -> _Files:
    """The daemon's program and the library of the geometry: those beside $DELAUNAYD, those in build/ of the repository, or compiled;
    none where they cannot be compiled."""
    chosen = os.environ.get("DELAUNAYD")
    build = Path(chosen).parent if chosen else REPOSITORY / "build"
    if all((build / target).is_file() for _, target, _ in _BINARIES):
        return _read(build)
    found = _compile()
    if found is None:
        print("delaunayd cannot be compiled here: the package will use the program and the library of the system")
    return found or []


def _tag(binaries: _Files) -> str:
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return "py3-none-" + (platform if binaries else "any")


def _license() -> _Files:
    text = REPOSITORY / "LICENSE"
    return [(INFO + "/LICENSE", text.read_bytes(), 0o644)] if text.is_file() else []


def _write_wheel(directory: str, tag: str, files: _Files) -> str:
    name = "%s-%s-%s.whl" % (PACKAGE, VERSION, tag)
    wheel = "Wheel-Version: 1.0\nGenerator: delaunayd\nRoot-Is-Purelib: %s\nTag: %s\n"
    files = files + _license() + [
        (INFO + "/METADATA", _metadata(), 0o644),
        (INFO + "/WHEEL", (wheel % (str(tag.endswith("any")).lower(), tag)).encode(), 0o644),
    ]
    record = []
    with zipfile.ZipFile(Path(directory) / name, "w", zipfile.ZIP_DEFLATED) as out:

        def add(path: str, content: bytes, mode: int) -> None:
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            out.writestr(entry, content)

        for path, content, mode in files:
            add(path, content, mode)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append("%s,sha256=%s,%d" % (path, digest, len(content)))
        record.append(INFO + "/RECORD,,")
        add(INFO + "/RECORD", ("\n".join(record) + "\n").encode(), 0o644)
    return name


def build_wheel(wheel_directory: str, config_settings: Any = None, metadata_directory: Optional[str] = None) -> str:
    sources = sorted([*(HERE / PACKAGE).rglob("*.py"), *(HERE / PACKAGE).rglob("*.pyi"), HERE / PACKAGE / "py.typed"])
    binaries = _binaries()
    files = [(path.relative_to(HERE).as_posix(), path.read_bytes(), 0o644) for path in sources]
    return _write_wheel(wheel_directory, _tag(binaries), files + binaries)


def build_editable(wheel_directory: str, config_settings: Any = None, metadata_directory: Optional[str] = None) -> str:
    files = [(PACKAGE + ".pth", (str(HERE) + "\n").encode(), 0o644)]
    return _write_wheel(wheel_directory, _tag([]), files)


def build_sdist(sdist_directory: str, config_settings: Any = None) -> str:
    raise NotImplementedError("there is no source distribution: the sources are the whole repository; build a wheel")
