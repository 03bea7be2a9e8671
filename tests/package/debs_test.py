"""Run by ctest: makes the Debian packages of this build and looks at what is in them.

    debs_test.py CPACK CONFIG_FILE VERSION WORK_DIR

The packages are compressed quickly here; scripts/packages makes those that are shipped, and tries them in a Debian of their own.
"""
import glob
import gzip
import os
import re
import shutil
import subprocess
import sys

CPACK, CONFIG_FILE, VERSION, WORK_DIR = sys.argv[1:5]
FULL_VERSION = VERSION + "-1"
SMOKE_JOB = ["optimize", "q1-complex", "--engine", "articulated", "--budget", "35", "--validation-cases", "1",
             "--set", "sets.test_cases=1", "--quiet", "--out"]

failures = []


def expect(condition, message):
    if not condition:
        failures.append(message)


def run(*words, **settings):
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **settings)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}: failed ({done.returncode})\n{done.stdout}")
    return done.stdout


def make_packages():
    shutil.rmtree(WORK_DIR, ignore_errors=True)
    os.makedirs(WORK_DIR)
    run(CPACK, "--config", CONFIG_FILE, "-B", WORK_DIR, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", "-D", "CPACK_THREADS=1")
    return {os.path.basename(file).split("_")[0]: file for file in glob.glob(WORK_DIR + "/*.deb")}


def list_files(package):
    """Path to (mode, owner) of everything that a package lays down."""
    files = {}
    for line in run("dpkg-deb", "--contents", package).splitlines():
        mode, owner, _, _, _, path = line.split(None, 5)
        files[path.split(" -> ")[0].lstrip(".")] = (mode, owner)
    return files


def check_contents(name, files, wanted):
    for path in wanted:
        expect(path in files, f"{name} lacks {path}")
    for path, (mode, owner) in files.items():
        expect(path.startswith("/usr/") or path in ("/", "/usr/"), f"{name} has {path}, which is not below /usr")
        expect(owner == "root/root", f"{name}: {path} belongs to {owner}")
        is_program = path.startswith("/usr/bin/") and path != "/usr/bin/" or path.endswith((".sh", ".py"))
        allowed = ["drwxr-xr-x"] if mode[0] == "d" else ["lrwxrwxrwx"] if re.search(r"/libarmwright\.so(\.\d+)?$", path) else ["-rwxr-xr-x"] if path == "/usr/bin/armwright" else ["-rw-r--r--"]
        if is_program:
            allowed.append("-rwxr-xr-x")
        expect(mode in allowed, f"{name}: {path} has the mode {mode} instead of {allowed[0]}")
    for paper in ["copyright", "changelog.gz", "changelog.Debian.gz"]:
        expect(f"/usr/share/doc/{name}/{paper}" in files, f"{name} lacks its {paper}")


def check_fields(name, package, wanted):
    fields = dict(re.findall(r"^ ?([\w-]+): (.*(?:\n (?! ?[\w-]+: ).*)*)", run("dpkg-deb", "--field", package), re.MULTILINE))
    wanted = {"Package": name, "Version": FULL_VERSION, **wanted}
    for field, pattern in wanted.items():
        expect(re.search(pattern, fields.get(field, "")), f"{name}: {field} is {fields.get(field)!r}, without {pattern!r}")
    control = run("dpkg-deb", "--info", package)
    expect("md5sums" in control, f"{name} has no md5sums")
    # The loader must know libarmwright. Python compiles what is imported, beside it.
    wanted_scripts = {"armwright": {"postinst", "postrm"}, "python3-armwright": {"postinst", "prerm"}}.get(name, set())
    scripts = {script for script in ["preinst", "postinst", "prerm", "postrm"] if re.search(rf"\b{script}\b", control)}
    expect(scripts == wanted_scripts, f"{name} has the maintainer scripts {sorted(scripts)} instead of {sorted(wanted_scripts)}")


def check_program(package, sources):
    root = os.path.join(WORK_DIR, "root")
    run("dpkg-deb", "--extract", package, root)
    program = root + "/usr/bin/armwright"
    expect("ldconfig" in run("dpkg-deb", "--info", package, "postinst"), "the loader is not told of libarmwright")
    library = root + f"/usr/lib/libarmwright.so.{VERSION}"
    expect(".debug_info" not in run("readelf", "--section-headers", library), "libarmwright is not stripped")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("ARMWRIGHT")}
    expect(run(program, "--version").startswith(f"armwright {VERSION}\n"), "the program has another version")
    expect(".debug_info" not in run("readelf", "--section-headers", program), "the program is not stripped")
    shipped = {file[: -len(".toml")] for file in os.listdir(sources + "/configs/problems") if not file.startswith("_")}
    names = set(run(program, "list", "problems", "--names", env=environment).split())
    expect(shipped <= names, f"the program does not find {sorted(shipped - names)} beside it")
    run(program, *SMOKE_JOB, WORK_DIR + "/run", env=environment)
    for optimizer in ["pagmo:de", "ceres:bfgs"]:  # from the modules
        run(program, "optimize", "sphere", "--optimizer", optimizer, "--budget", "60", "--out", WORK_DIR + "/" + optimizer, env=environment)
    expect(os.path.exists(WORK_DIR + "/run/result.json"), "the smoke job left no result")
    pages = glob.glob(root + "/usr/share/man/man1/*.gz")
    for page in pages:
        with gzip.open(page, "rt") as file:
            expect(f'"armwright {VERSION}"' in file.read(), f"{page} is of another version")
    commands = run(program, "manual").count("(1)")
    expect(len(pages) > 20 and commands > 20, f"there are {len(pages)} manual pages")
    with gzip.open(root + "/usr/share/doc/armwright/changelog.Debian.gz", "rt") as file:
        expect(file.read().startswith(f"armwright ({FULL_VERSION}) "), "changelog.Debian.gz begins with another version")


def main():
    packages = make_packages()
    sources = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    expect({"armwright", "armwright-dev"} <= packages.keys(), f"only {sorted(packages)} were made")
    files = {name: list_files(package) for name, package in packages.items()}
    check_contents("armwright", files["armwright"], [
        "/usr/bin/armwright", "/usr/share/armwright/configs/problems/q1-complex.toml", "/usr/share/doc/armwright/README.md",
        "/usr/share/man/man1/armwright.1.gz", "/usr/share/man/man1/armwright-testset-export.1.gz",
        "/usr/share/bash-completion/completions/armwright", "/usr/share/armwright/plugins/scipy_de/scipy_de.py",
        "/usr/lib/armwright/libarmwright_ceres.so", "/usr/lib/armwright/libarmwright_pagmo.so", f"/usr/lib/libarmwright.so.{VERSION}", f"/usr/lib/libarmwright.so.{VERSION.split('.')[0]}",
        "/usr/share/armwright/examples/own_program/own_program.cpp"])
    check_fields("armwright", packages["armwright"], {
        "Depends": r"libc6 \(>= .*libode8.*libpagmo8.*libsqlite3-0", "Section": "science", "Priority": "optional",
        "Description": r"(?s)^tunes .*\n .*physics engine", "Maintainer": "armwright developers <.*@.*>", "Suggests": "python3-scipy"})
    check_contents("armwright-dev", files["armwright-dev"], [
        "/usr/include/armwright/plugin.h", "/usr/include/armwright/problem.hpp", "/usr/include/armwright/run.h",
        "/usr/lib/libarmwright.so", "/usr/include/armwright/base/error.hpp", "/usr/lib/libarmwright_base.a",
        "/usr/lib/cmake/armwright/armwrightConfig.cmake"])
    check_fields("armwright-dev", packages["armwright-dev"], {
        "Depends": rf"armwright \(= {FULL_VERSION}\).*libeigen3-dev", "Section": "libdevel"})
    if "python3-armwright" in packages:
        check_contents("python3-armwright", files["python3-armwright"], [
            "/usr/lib/python3/dist-packages/armwright/libarmwright_pagmo.so"])
        check_fields("python3-armwright", packages["python3-armwright"], {
            "Depends": rf"armwright \(= {FULL_VERSION}\).*python3 \(<< 3.12\).*python3-numpy", "Section": "python"})
    # No file is in two packages: dpkg would refuse the second.
    places = {}
    for name, paths in files.items():
        for path in paths:
            if not path.endswith("/"):
                expect(path not in places, f"{path} is in {name} and in {places.get(path)}")
                places[path] = name
    check_program(packages["armwright"], sources)
    if failures:
        sys.exit("\n".join(failures))
    print(f"{', '.join(sorted(packages))}: {len(places)} files")


main()
