# SPDX-License-Identifier: BSD-3-Clause
"""What pip calls to make a wheel or an archive of the source (PEP 517): setuptools, with CMake to build and to install.

setuptools rather than scikit-build-core, as Debian 12 packages it: the way that users go is then tested without network.
A wheel holds what `cmake --install --component python` installs. `CMAKE_ARGS` in the environment are arguments for a new
build folder, such as `-DFRAC_BUILD_FITTING=OFF`; `--config-settings build-dir=FOLDER` takes a folder that is configured.
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile

from setuptools import build_meta
from setuptools.build_meta import build_sdist, get_requires_for_build_sdist  # noqa: F401
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # before setuptools 70
    from wheel.bdist_wheel import bdist_wheel

ROOT = pathlib.Path(__file__).resolve().parents[2]
OPTIONS = ("FRACFIT_PYTHON=ON", "FRAC_BUILD_TESTS=OFF", "FRAC_BUILD_TOOLS=OFF", "FRAC_BUILD_BENCHMARKS=OFF")

_lists = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
_suffix = re.search(r"set\(FRACFIT_VERSION \$\{PROJECT_VERSION\}(-dev)?\)", _lists)[1]
version = re.search(r"project\(fracfit VERSION ([0-9.]+)", _lists)[1] + (".dev0" if _suffix else "")

_build_folder = ROOT / "build" / f"python-{sys.implementation.cache_tag}"
_egg_base = ROOT / "build"
_egg_base.mkdir(exist_ok=True)


def _pybind11():
    """Arguments by which CMake finds pybind11 of this Python; none where it finds that of the system, or none at all."""
    try:
        import pybind11
    except ImportError:
        return []
    return [f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]


def get_requires_for_build_wheel(config_settings=None):
    needed = build_meta.get_requires_for_build_wheel(config_settings)
    needed += [tool for tool in ("cmake>=3.22", "ninja") if not shutil.which(re.split("[<>]", tool)[0])]
    system = any(pathlib.Path(prefix, "cmake/pybind11").is_dir() for prefix in ("/usr/lib", "/usr/share", "/usr/local/share"))
    return needed + ([] if system else ["pybind11>=2.10"])


prepare_metadata_for_build_wheel = build_meta.prepare_metadata_for_build_wheel


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    global _build_folder
    _build_folder = pathlib.Path((config_settings or {}).get("build-dir", _build_folder)).resolve()
    return build_meta.build_wheel(wheel_directory, None, metadata_directory)


def _run(*command):
    print("+", shlex.join(map(str, command)), flush=True)
    if subprocess.run(list(map(str, command))).returncode:
        sys.exit(f"fracfit: {command[0]} failed; what is missing stands above, what is needed in tools/python/README.md")


class InstalledByCMake(build_py):
    """The files of the package are those of the component `python`."""

    def run(self):
        if not (_build_folder / "CMakeCache.txt").exists():
            ninja = ["-G", "Ninja"] if shutil.which("ninja") else []
            _run(
                *("cmake", "-S", ROOT, "-B", _build_folder, *ninja, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON"),
                *(f"-DPython_EXECUTABLE={sys.executable}", *_pybind11(), *(f"-D{option}" for option in OPTIONS)),
                *shlex.split(os.environ.get("CMAKE_ARGS", "")),
            )
        _run("cmake", "--build", _build_folder, "--target", "fracfit_python", "--parallel", os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", os.cpu_count() or 1))
        package = pathlib.Path(self.build_lib, "fracfit")
        shutil.rmtree(package, ignore_errors=True)
        with tempfile.TemporaryDirectory() as prefix:
            _run("cmake", "--install", _build_folder, "--component", "python", "--strip", "--prefix", prefix)
            shutil.copytree(next(pathlib.Path(prefix).rglob("fracfit/__init__.py")).parent, package)
        suffix = sysconfig.get_config_var("EXT_SUFFIX")
        if not (package / f"_core{suffix}").exists():
            sys.exit(f"fracfit: {_build_folder} is configured for another Python, there is no _core{suffix}")


class WholeSource(sdist):
    """Every file under version control, or every file where there is none, as in an archive that was unpacked."""

    def make_distribution(self):
        if (ROOT / ".git").exists():
            listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True, text=True)
            files = [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]
        else:
            files = [str(path.relative_to(ROOT)) for path in sorted(ROOT.rglob("*")) if path.is_file()]
            files = [name for name in files if name.split(os.sep)[0] != "build" and "__pycache__" not in name]
        self.filelist.files = files
        super().make_distribution()


class WheelOfOneMachine(bdist_wheel):
    """The tag names the Python, its ABI and the machine, as for any package with compiled parts."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False
