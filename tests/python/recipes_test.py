# SPDX-License-Identifier: BSD-3-Clause
"""Recipes for other package managers, as far as they can be judged where these are not installed: they parse, name the
version, the options and the packages that the project has, and what they configure configures."""

import json
import pathlib
import re
import shutil
import subprocess

import command_line
import pytest

ROOT = pathlib.Path(command_line.DATA).parent
PACKAGING = ROOT / "tools/packaging"
LISTS = (ROOT / "CMakeLists.txt").read_text()
VERSION = re.search(r"project\(fracfit VERSION ([0-9.]+)", LISTS)[1]
CONTROL = (PACKAGING / "debian/control").read_text()


def names_of(lines):
    return {re.split(r"[ <>=]", line)[0] for line in lines if isinstance(line, str) and not line.startswith("$")}


def test_the_recipe_for_conda_is_that_of_this_project():
    yaml = pytest.importorskip("yaml")
    recipe = yaml.safe_load((PACKAGING / "conda/recipe.yaml").read_text())
    assert recipe["schema_version"] == 1 and recipe["context"]["version"] == VERSION
    assert (PACKAGING / "conda" / recipe["source"]["path"]).resolve() == ROOT.resolve()
    assert (ROOT / recipe["about"]["license_file"]).exists()
    tomllib = pytest.importorskip("tomllib")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    asked = recipe["requirements"]
    assert {"cmake", "ninja"} <= names_of(asked["build"])
    assert {"python", "pip", "pybind11"} | names_of(project["build-system"]["requires"]) <= names_of(asked["host"])
    for each in project["project"]["dependencies"]:
        assert re.sub("([<>])", r" \1", each, count=1) in asked["run"]
    assert recipe["about"]["summary"] == project["project"]["description"]
    # The sentence that tests the package is one of Python.
    compile(re.search('-c "(.*)"', recipe["tests"][1]["script"][0])[1], "test", "exec")


def test_the_port_for_vcpkg_configures(tmp_path):
    folder = PACKAGING / "vcpkg/fracfit"
    manifest = json.loads((folder / "vcpkg.json").read_text())
    assert manifest["version"] == VERSION and manifest["name"] == folder.name
    names = [each if isinstance(each, str) else each["name"] for each in manifest["dependencies"]]
    assert names == sorted(names)  # as vcpkg format-manifest leaves them
    # Its functions as far as they matter here: the feature is asked for, and configuring is done.
    (tmp_path / "vcpkg.cmake").write_text(
        f"""
set(CURRENT_PORT_DIR {folder})
set(CURRENT_PACKAGES_DIR {tmp_path}/packages)
function(vcpkg_check_features)
  cmake_parse_arguments(PARSE_ARGV 0 A "" "OUT_FEATURE_OPTIONS" "FEATURES")
  list(POP_FRONT A_FEATURES name option)
  file(WRITE {tmp_path}/feature "${{name}}")
  set(${{A_OUT_FEATURE_OPTIONS}} -D${{option}}=ON PARENT_SCOPE)
endfunction()
function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 A "" "SOURCE_PATH" "OPTIONS")
  execute_process(COMMAND ${{CMAKE_COMMAND}} -S ${{A_SOURCE_PATH}} -B {tmp_path}/build -G Ninja ${{A_OPTIONS}}
                  OUTPUT_FILE {tmp_path}/log COMMAND_ERROR_IS_FATAL ANY)
  file(WRITE {tmp_path}/options "${{A_OPTIONS}}")
endfunction()
function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 A "" "" "FILE_LIST")
  if(NOT EXISTS ${{A_FILE_LIST}})
    message(FATAL_ERROR "there is no ${{A_FILE_LIST}}")
  endif()
endfunction()
foreach(name IN ITEMS vcpkg_cmake_install vcpkg_cmake_config_fixup vcpkg_fixup_pkgconfig)
  cmake_language(EVAL CODE "function(${{name}})\\nendfunction()")
endforeach()
include({folder}/portfile.cmake)
"""
    )
    done = subprocess.run(["cmake", "-P", tmp_path / "vcpkg.cmake"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "Manually-specified variables were not used" not in done.stderr
    assert list(manifest["features"]) == [(tmp_path / "feature").read_text()]
    for option in re.findall(r"-D(\w+)=", (tmp_path / "options").read_text()):
        assert f"option({option} " in LISTS, option


def test_the_formula_for_homebrew_is_the_port_for_vcpkg():
    formula = PACKAGING / "homebrew/fracfit.rb"
    text = formula.read_text()
    manifest = json.loads((PACKAGING / "vcpkg/fracfit/vcpkg.json").read_text())
    assert re.search('^  desc "(.*)"$', text, re.MULTILINE)[1] == manifest["description"]
    assert f'license "{manifest["license"]}"' in text
    # The same options but for the fit, which is built, and the libraries under their names there; Boost is one package.
    port = (PACKAGING / "vcpkg/fracfit/portfile.cmake").read_text()
    assert re.findall(r"-D\w+=\w+", text) == re.findall(r"-D\w+=\w+", port)
    wanted = [*manifest["dependencies"][:3], *manifest["features"]["fitting"]["dependencies"]]
    renamed = {"boost-math": "boost", "boost-multiprecision": "boost", "eigen3": "eigen", "ceres": "ceres-solver"}
    assert set(re.findall(r'depends_on "([\w-]+)"$', text, re.MULTILINE)) == {renamed.get(name, name) for name in wanted}
    top = re.search(r'expand_path\("(.*?)", __dir__\)', text)[1]
    assert (formula.parent / top).resolve() == ROOT.resolve()
    ruby = shutil.which("ruby")
    if ruby is not None:
        assert subprocess.run([ruby, "-c", formula], capture_output=True).returncode == 0


def test_the_container_has_what_the_packages_are_built_from():
    text = (PACKAGING / "container/Containerfile").read_text().replace("\\\n", " ")
    steps = [line.split()[0] for line in text.splitlines() if line and not line.startswith("#")]
    assert set(steps) <= {"FROM", "SHELL", "RUN", "COPY", "WORKDIR", "USER", "ENTRYPOINT", "CMD"}
    installed = set(re.search(r"--no-install-recommends (.*?) &&", text)[1].split())
    field = re.search(r"^Build-Depends:(.*?)^\S", CONTROL, re.DOTALL | re.MULTILINE)[1]
    needed = {name.split()[0] for name in field.split(",")} - {"debhelper-compat", "dh-sequence-python3"}
    assert needed <= installed, needed - installed
    assert re.search(r"^USER (?!root)", text, re.MULTILINE)  # does not run as root
