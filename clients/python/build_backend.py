"""Builds the package (PEP 517) with the standard library alone. The wheel contains the daemon's program: $DELAUNAYD, or the one in
build/ of the repository, or else one that is compiled in a temporary directory. No files are left in the source tree."""

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
from typing import Any, Iterator, List, Optional, Tuple

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
        "Requires-Python: " + _field("requires-python"),
        "Provides-Extra: numpy",
        'Requires-Dist: numpy; extra == "numpy"',
        "Description-Content-Type: text/markdown",
        "",
        (HERE / "README.md").read_text(),
    ]
    return "\n".join(lines).encode()


@contextlib.contextmanager
def _program() -> Iterator[Optional[Path]]:
    """The path of the daemon's program; None if there is none and none can be compiled."""
    built = os.environ.get("DELAUNAYD") or REPOSITORY / "build" / "delaunayd"
    if Path(built).is_file():
        yield Path(built)
        return
    with tempfile.TemporaryDirectory() as scratch:
        program = Path(scratch) / "delaunayd"
        command = ["make", "-s", "-j%d" % (os.cpu_count() or 1), "-C", str(REPOSITORY), "O=" + scratch, str(program)]
        made = shutil.which("make") and (REPOSITORY / "Makefile").is_file() and subprocess.call(command) == 0
        if not made:
            print("delaunayd cannot be compiled here: the package will use the one of $PATH")
        yield program if made else None


def _tag(program: Optional[Path]) -> str:
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return "py3-none-" + (platform if program is not None else "any")


def _write_wheel(directory: str, tag: str, files: List[Tuple[str, bytes, int]]) -> str:
    """`files`: name, content, mode."""
    name = "%s-%s-%s.whl" % (PACKAGE, VERSION, tag)
    wheel = "Wheel-Version: 1.0\nGenerator: delaunayd\nRoot-Is-Purelib: %s\nTag: %s\n"
    files = files + [
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
    sources = sorted((HERE / PACKAGE).glob("*.py*"))
    files = [("%s/%s" % (PACKAGE, path.name), path.read_bytes(), 0o644) for path in sources]
    with _program() as program:
        if program is not None:
            files.append((PACKAGE + "/bin/delaunayd", program.read_bytes(), 0o755))
        return _write_wheel(wheel_directory, _tag(program), files)


def build_editable(wheel_directory: str, config_settings: Any = None, metadata_directory: Optional[str] = None) -> str:
    files = [(PACKAGE + ".pth", (str(HERE) + "\n").encode(), 0o644)]
    return _write_wheel(wheel_directory, _tag(None), files)


def build_sdist(sdist_directory: str, config_settings: Any = None) -> str:
    raise NotImplementedError("there is no source distribution: the sources are the whole repository; build a wheel")
