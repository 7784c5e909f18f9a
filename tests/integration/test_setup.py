"""Set-up and the whole check on a machine that has nothing: what they decide. No package is installed here."""

import fcntl
import json
import os
import re
import shutil
import subprocess
import sys
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

import pytest
from places import ROOT

#: In place of pip: writes down what it was asked, and knows the settings in the file ``settings`` of the folder.
PIP = """
import json, pathlib, sys
from urllib.parse import quote
if sys.argv[1:3] == ["config", "list"]:
    sys.exit(print(pathlib.Path("settings").read_text(), end=""))
with open("asked", "a") as asked:
    print(*sys.argv[1:], file=asked)
for k, word in enumerate(sys.argv):
    if word == "--editable":
        note = pathlib.Path(__file__).parents[1] / f"granular_response{k}.dist-info" / "direct_url.json"
        note.parent.mkdir(exist_ok=True)
        url = "file://" + quote(str(pathlib.Path(sys.argv[k + 1]).absolute()))
        note.write_text(json.dumps({"url": url, "dir_info": {"editable": True}}))
sys.exit(pathlib.Path("pip-fails").exists())
"""


@pytest.fixture
def setup(tmp_path, monkeypatch):
    """The script, as that of a checkout in a new folder whose environments have the pip above."""
    checkout = tmp_path / "a größe's #1 (100 %; a&b)"
    for name in (".ci/setup", "requirements.lock", "pyproject.toml", "src/granular_response_paper", "extensions"):
        source = ROOT / name
        name = f"{name}/pyproject.toml" if source.is_dir() else name
        (checkout / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, checkout / name)
    (checkout / ".git").touch()
    (checkout / "settings").touch()
    return loaded(checkout, monkeypatch)


def loaded(checkout, monkeypatch):
    """The script of a checkout, in its folder."""
    monkeypatch.chdir(checkout)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    loader = SourceFileLoader("setup_script", str(checkout / ".ci" / "setup"))
    spec = spec_from_loader(loader.name, loader)
    assert spec is not None
    module = module_from_spec(spec)
    loader.exec_module(module)
    run = subprocess.run

    def venv_without_pip(command, **options):
        if "venv" not in command:
            return run(command, **options)
        done = run([*command, "--without-pip"], **options)
        (site,) = Path(".venv").glob("lib/python*/site-packages")
        (site / "pip").mkdir(exist_ok=True)
        (site / "pip" / "__init__.py").touch()
        (site / "pip" / "__main__.py").write_text(PIP)
        return done

    monkeypatch.setattr(module.subprocess, "run", venv_without_pip)
    return module


def asked():
    """What pip was asked since the last look."""
    file = Path("asked")
    lines = file.read_text().splitlines() if file.exists() else []
    file.unlink(missing_ok=True)
    return lines


def whole(setup):
    setup.main([])
    assert setup.usable() and setup.installed("paper") and len(asked()) == 2


def test_versions_come_first_then_the_packages_of_the_checkout_and_nothing_twice(setup, capsys):
    setup.main([])
    versions, own = asked()
    assert "--constraint requirements.lock hatchling editables" in versions and "--no-build-isolation" not in versions
    assert own.count("--editable") == 3 and "--no-deps" in own and "--no-build-isolation" in own
    setup.main([])
    assert asked() == []
    setup.main(["--tools"])
    (tools,) = asked()
    assert " pytest==" in tools
    setup.main(["--tools"])
    assert asked() == [] and capsys.readouterr().out.count("Installing") == 2


@pytest.mark.parametrize(
    "damage",
    [
        "ln -sf /nowhere/python .venv/bin/python",
        "rm -r .venv/lib/python*/site-packages/pip",
        "rm -r .venv; touch .venv",
        "touch .venv-begun",
    ],
)
def test_an_environment_that_is_not_whole_is_made_anew(setup, damage):
    whole(setup)
    Path(".venv/of-before").touch()
    subprocess.run(["sh", "-c", damage], check=True)
    whole(setup)
    assert not Path(".venv/of-before").exists()


@pytest.mark.parametrize("content", [b"", b"\xff\0"], ids=["empty", "spoilt"])
@pytest.mark.parametrize("name", [".folder", ".paper", "direct_url.json"])
def test_a_note_of_the_set_up_that_is_damaged_is_made_anew(setup, name, content):
    whole(setup)
    note, *_ = Path(".venv").rglob(name)
    note.write_bytes(content)
    whole(setup)
    assert note.read_bytes() != content


def test_an_environment_of_somebody_is_not_lost(setup, capsys):
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", ".venv"], check=True)
    Path(".venv/mine").touch()
    whole(setup)
    (aside,) = Path().glob(".venv-before-*")
    assert (aside / "mine").exists() and not Path(".venv/mine").exists()
    assert f".venv was not made by this set-up, and is {aside} now" in capsys.readouterr().out


@pytest.mark.parametrize("elsewhere", [False, True], ids=["copied", "editable"])
def test_packages_that_another_clone_has_put_there_are_replaced(setup, elsewhere):
    whole(setup)
    note = next(Path(".venv").glob("lib/python*/site-packages/*.dist-info/direct_url.json"))
    note.write_text(json.dumps({"url": "file:///other", "dir_info": {"editable": True} if elsewhere else {}}))
    assert setup.usable() and not setup.installed("paper")
    whole(setup)


def test_the_next_set_up_waits_for_what_a_killed_one_has_started(setup):
    """Else both write into the environment."""
    setup.make()
    setup.BEGUN.unlink()
    (code,) = Path(".venv").glob("lib/python*/site-packages/pip/__main__.py")
    waits = "print('begun', flush=True)\n    open('gate').read()"
    code.write_text(f"import sys\nif sys.argv[1] == 'install':\n    {waits}\n")
    os.mkfifo("gate")
    run = subprocess.Popen([sys.executable, "-I", setup.__file__], stdout=subprocess.PIPE, text=True)
    assert run.stdout.readline().startswith("Installing") and run.stdout.readline() == "begun\n"
    run.kill()
    run.wait()
    with open(setup.__file__) as held:
        with pytest.raises(BlockingIOError):
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        open("gate", "w").close()  # now it ends
        fcntl.flock(held, fcntl.LOCK_EX)


def test_an_environment_is_made_within_the_checkout_where_a_link_leads_out_of_it(setup, tmp_path):
    """What the link leads to is somebody else's."""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "file").touch()
    Path(".venv").symlink_to(elsewhere)
    whole(setup)
    assert not Path(".venv").is_symlink() and [one.name for one in elsewhere.iterdir()] == ["file"]


@pytest.mark.parametrize("way", [shutil.copytree, shutil.move])
def test_the_environment_of_a_copied_or_renamed_checkout_is_made_anew(setup, tmp_path, monkeypatch, way):
    whole(setup)
    there = tmp_path / "there"
    monkeypatch.chdir(tmp_path)
    way(Path(setup.__file__).parents[1], there, **({"symlinks": True} if way is shutil.copytree else {}))
    assert not loaded(there, monkeypatch).usable()


def test_a_new_version_in_the_lock_is_installed_into_the_environment_that_is_there(setup):
    whole(setup)
    Path(".venv/of-before").touch()
    with open("requirements.lock", "a") as lock:
        lock.write("# another\n")
    whole(setup)
    assert Path(".venv/of-before").exists()


def test_another_python_is_taken_only_where_it_was_asked_for(setup, monkeypatch):
    whole(setup)
    monkeypatch.setattr(setup.sys, "version_info", (3, 99, 0))
    assert setup.usable() and not setup.usable(this_python=True)
    setup.main([])
    assert asked() == []
    setup.main(["--this-python"])
    assert len(asked()) == 2


def test_what_pip_did_not_end_is_done_again(setup):
    Path("pip-fails").touch()
    with pytest.raises(SystemExit, match="pip ended with status 1"):
        setup.main([])
    Path("pip-fails").unlink()
    asked()
    assert not (setup.usable() and setup.installed("paper"))
    whole(setup)


def test_of_the_settings_of_pip_those_count_that_say_how_packages_are_reached(setup):
    Path("settings").write_text(
        ":env:.find-links='/wheels'\n:env:.user='1'\nglobal.index-url='http://global/x=1'\nglobal.target='/tmp/x'\n"
        "install.index-url='http://install/x=1'\ninstall.no-deps='true'\ninstall.require-hashes='true'\n"
        "global.extra-index-url='\\nhttp://one\\nhttp://two'\nlist.proxy='http://other'\nglobal.only-binary=':all:'\n"
    )
    setup.make()
    assert setup.pip_settings() == {
        "PIP_FIND_LINKS": "/wheels",
        "PIP_INDEX_URL": "http://install/x=1",
        "PIP_EXTRA_INDEX_URL": "http://one http://two",
    }


def test_pip_sees_no_other_setting_of_the_user(setup, monkeypatch):
    setup.make()
    reached = {}
    run = setup.subprocess.run
    monkeypatch.setattr(setup.subprocess, "run", lambda words, **given: reached.update(given) or run(words, **given))
    for name in ("PIP_USER", "PIP_TARGET", "PIP_CONFIG_FILE", "PIP_NO_DEPS", "PYTHONHOME", "PYTHONPATH"):
        monkeypatch.setenv(name, "/somewhere")
    monkeypatch.setattr(setup, "pip_settings", lambda: {"PIP_PROXY": "http://proxy"})
    setup.pip("nothing")
    names = {name for name in reached["env"] if name.startswith(("PIP_", "PYTHON"))}
    assert names == {"PIP_PROXY", "PIP_CONFIG_FILE", "PIP_DISABLE_PIP_VERSION_CHECK"}
    assert reached["env"]["PIP_CONFIG_FILE"] == os.devnull


def test_a_python_that_makes_no_environments_names_the_package_that_is_missing(setup, monkeypatch):
    monkeypatch.setattr(setup.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(SystemExit, match=rf"apt install python3\.{sys.version_info.minor}-venv$"):
        setup.main([])
    assert not Path(".venv").exists()


@pytest.mark.parametrize("sign", [b":", b"$", b"[", b"{", b"}", b"\xff"])
def test_a_path_that_a_tool_misreads_is_refused_in_one_line(tmp_path, sign):
    script = Path(os.fsdecode(os.fsencode(tmp_path) + b"/a" + sign + b"b")) / ".ci" / "setup"
    script.parent.mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "setup", script)
    done = subprocess.run([sys.executable, "-I", script], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    said = (
        "path or locale is not UTF-8"
        if sign == b"\xff"
        else f"{script.parents[1]}: the path has a {sign.decode()}, which"
    )
    assert said in done.stderr


MAKEFILE = "reproduce test lint docs wheels:\n\t@echo $@: 3 passed\n"


@pytest.fixture
def check(tmp_path):
    """Runs the whole check on a repository with this README and this Makefile."""

    def run(readme, makefile=MAKEFILE):
        repository = tmp_path / "repository"
        (repository / ".ci").mkdir(parents=True)
        for name in "run", "setup":
            shutil.copy(ROOT / ".ci" / name, repository / ".ci" / name)
        (repository / "README.md").write_text(readme)
        (repository / "Makefile").write_text(makefile)
        somebody = ("-c", "user.name=somebody", "-c", "user.email=somebody@here")
        for words in ("init", "-q"), ("add", "."), ("commit", "-qm", "all"):
            subprocess.run(["git", *somebody, *words], cwd=repository, check=True)
        # as the script sees it where no Python of the user's is in the way
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        environment = os.environ | {"PATH": path, "TMPDIR": str(tmp_path)}
        done = subprocess.run([repository / ".ci" / "run"], env=environment, capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    return run


BLOCKS = "# A\n\n```python\nno shell\n```\n\n```sh\nmake reproduce  # all\n{}\n```\n\nwords\n\n```sh\nmake test\n```\n"


def test_the_check_runs_the_commands_of_the_readme_and_shows_what_they_say(check):
    status, out, err = check(BLOCKS.format('test "$HOME" != ~root -a -z "${PYTHONPATH:-}"'))
    assert status == 0, err
    assert [line for line in out.splitlines() if "passed" in line] == [
        f"{one}: 3 passed" for one in ("reproduce", "test", "lint", "docs", "wheels")
    ]
    assert "nothing differs" in out


def test_the_check_has_what_packages_are_reached_by_and_nothing_else_of_the_user(check, monkeypatch):
    proxies = {f"{one}_proxy" for one in ("http", "https", "all", "no")}
    reaching = proxies | {one.upper() for one in proxies} | {"SSL_CERT_FILE", "REQUESTS_CA_BUNDLE"}
    for name in (*reaching, "PYTHONPATH", "MPLBACKEND", "FORCE_COLOR", "DVC_ROOT", "PIP_USER"):
        monkeypatch.setenv(name, "/some where")
    for name in ("SSL_CERT_DIR", "CURL_CA_BUNDLE"):
        monkeypatch.delenv(name, raising=False)
    status, out, err = check(BLOCKS.format("env"))
    assert status == 0, err
    found = dict(re.findall(r"^(\w+)=(.*)$", out, re.M))
    own = {"PATH", "HOME", "LANG", "TERM", "CI", "DVC_SITE_CACHE_DIR", "PWD", "SHLVL", "_", "PIP_NO_CACHE_DIR"}
    assert {name for name, value in found.items() if value == "/some where"} == reaching
    assert {name for name in found if not name.startswith("PIP_")} <= own | reaching


BROKEN = "reproduce test lint wheels:\n\t@echo $@\ndocs:\n\t@false\n"


@pytest.mark.parametrize(
    ("readme", "makefile", "said"),
    [
        (BLOCKS.format("false | cat"), MAKEFILE, "false | cat"),
        (BLOCKS.format("echo '# more' >> Makefile"), MAKEFILE, " M Makefile"),
        (BLOCKS.format("git config status.showUntrackedFiles no; touch file"), MAKEFILE, "?? file"),
        (BLOCKS.format(""), BROKEN, "Error 1"),
        ("    make reproduce\n    make test\n", MAKEFILE, "README.md has no shell block with make reproduce\n"),
    ],
)
def test_the_check_fails_with_a_command_of_the_readme_a_target_or_a_file_that_differs(check, readme, makefile, said):
    status, out, err = check(readme, makefile)
    assert status != 0 and said in err and "nothing differs" not in out
