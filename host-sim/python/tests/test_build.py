"""host-sim is compiled once for the tests, `vm` and this package: each choice of packages must ask
the same features of what host-sim depends on. Only manifests are read."""

import subprocess

import pytest
from conftest import ROOT


def features(*choice):
    """The features of each package in a build; a package for the build's own tools has others."""
    command = ["cargo", "tree", "--locked", "--offline", "--prefix", "none", "--format", "{p}|{f}"]
    tree = subprocess.run(
        [*command, *choice], cwd=ROOT, check=True, capture_output=True, text=True, timeout=60
    )
    found = {}
    for line in tree.stdout.splitlines():
        package, _, named = line.removesuffix(" (*)").partition("|")
        found.setdefault(package.removesuffix(" (proc-macro)"), set()).add(named)
    return found


@pytest.mark.parametrize(
    "choice",
    [["--edges", "normal,build,dev"], ["--edges", "normal,build"],
     ["--edges", "normal,build", "--package", "vm-nostd-python"]],
    ids=["cargo test", "cargo build", "pip install"],
)  # fmt: skip
def test_host_sim_is_compiled_once(choice):
    alone = features("--edges", "normal,build", "--package", "host-sim")
    chosen = features(*choice)
    other = {
        package: (sorted(own), sorted(chosen[package]))
        for package, own in alone.items()
        if not own <= chosen[package]
    }
    assert len(alone) > 100 and other == {}, "ask for these in host-sim/Cargo.toml"
