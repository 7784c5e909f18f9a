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
    of_pip = ("PIP_USER", "PIP_TARGET", "PIP_CONFIG_FILE", "PIP_NO_DEPS")
    for name in (*of_pip, "PYTHONHOME", "PYTHONPATH", "SETUPTOOLS_USE_DISTUTILS"):
        monkeypatch.setenv(name, "/somewhere")
    monkeypatch.setattr(setup, "pip_settings", lambda: {"PIP_PROXY": "http://proxy"})
    setup.pip("nothing")
    names = {name for name in reached["env"] if name.startswith(("PIP_", "PYTHON", "SETUPTOOLS_"))}
    assert names == {"PIP_PROXY", "PIP_CONFIG_FILE", "PIP_DISABLE_PIP_VERSION_CHECK"}
    assert reached["env"]["PIP_CONFIG_FILE"] == os.devnull


@pytest.mark.parametrize("sign", [b":", b"$", b'"', b"`", b"\\", b"\n", b"[", b"{", b"}", b"\xff"])
def test_a_path_that_a_tool_misreads_is_refused_in_one_line(tmp_path, sign):
    script = Path(os.fsdecode(os.fsencode(tmp_path) + b"/a" + sign + b"b")) / ".ci" / "setup"
    script.parent.mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "setup", script)
    done = subprocess.run([sys.executable, "-I", script], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    path, sign = (one.replace("\n", "\\n") for one in (str(script.parents[1]), os.fsdecode(sign)))
    said = "path or locale is not UTF-8" if sign == "\udcff" else f"{path}: the path has a {sign}, which"
    assert said in done.stderr


MAKEFILE = "reproduce test lint docs wheels:\n\t@echo $@: 3 passed\n"


@pytest.fixture
def made(tmp_path):
    """Runs make in a checkout where set-up only says that it runs, and the Python of .venv who started it."""
    checkout = tmp_path / "a checkout"
    group = checkout / "src" / "granular_response_paper" / "groups" / "one" / "parameters.py"
    for file in (checkout / ".ci" / "setup", checkout / ".venv" / "bin" / "python", group):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    (checkout / ".ci" / "setup").write_text("import sys\nprint('set up', *sys.argv[1:])\n")
    (checkout / ".venv" / "bin" / "python").write_text("#!/bin/sh\necho $PPID $*\n")
    (checkout / ".venv" / "bin" / "python").chmod(0o755)
    shutil.copy(ROOT / "Makefile", checkout)
    (checkout / ".ci" / "figure").write_bytes((ROOT / ".ci" / "figure").read_bytes())  # as zipfile unpacks it

    def run(*words, folder=checkout, **environment):
        run = subprocess.Popen(
            ["make", *words], cwd=folder, env=os.environ | environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip
        out, err = run.communicate()
        return run.returncode, out.replace(f"{run.pid} ", "MAKE "), err

    run.checkout = checkout
    return run


def test_a_python_may_have_a_path_with_blanks_and_one_that_is_none_is_refused(made, tmp_path):
    other = tmp_path / "my Python's" / "python"
    other.parent.mkdir()
    other.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    other.chmod(0o755)
    assert made("setup", f"PYTHON={other}") == (0, "set up --this-python\n", "")
    for name in "", "/nowhere/python3":
        for given in {"words": ("setup", f"PYTHON={name}")}, {"words": ("setup",), "PYTHON": name}:
            status, out, err = made(*given.pop("words"), **given)
            assert (status, out) == (2, "") and err.startswith(f"PYTHON={name}: not there, or older than Python 3.11")


@pytest.mark.parametrize("content", ["", "#!/nowhere/python\n", "#!/bin/sh\nexit 127\n"], ids=["cut", "gone", "fails"])
def test_a_python_in_the_environment_that_does_not_run_is_not_taken_for_that_of_the_user(made, content):
    """Its folder is the first on the path of all that make runs. An empty file is a program that does nothing."""
    for name in "python", "python3":
        (made.checkout / ".venv" / "bin" / name).write_text(content)
        (made.checkout / ".venv" / "bin" / name).chmod(0o755)
    assert made("setup") == (0, "set up\n", "") and made("tools") == (0, "set up --tools\n", "")


def test_make_runs_in_its_own_folder_alone(made, tmp_path):
    """Else ``clean`` removes what is in another one."""
    (tmp_path / ".venv").mkdir()
    status, out, err = made("-f", str(made.checkout / "Makefile"), "clean", folder=tmp_path)
    assert (status, out, err.count("\n")) == (2, "", 1) and "is not the folder of this Makefile: make -C" in err
    assert (tmp_path / ".venv").exists()
    assert made("-C", str(made.checkout), "setup", folder=tmp_path)[0] == 0


def test_a_figure_is_drawn_by_a_process_that_gets_the_signals_of_make(made):
    """Make passes SIGTERM on to what it has started itself, not to what a shell has."""
    picture = made.checkout / "figures" / "one" / "a.png"
    picture.parent.mkdir(parents=True)
    picture.touch()
    status, out, err = made("figure", "GROUP=one", GIT_CEILING_DIRECTORIES=str(made.checkout.parent))
    said, drawn, compared = out.splitlines()
    assert (status, said) == (0, "set up"), err
    assert drawn == "MAKE -P -m granular_response_paper reproduce --group one"
    assert compared.startswith("figures/one/a.png (not compared: fatal: not a git repository")
    status, out, err = made("figure", "GROUP=two")
    assert (status, out) == (2, "") and err.startswith("GROUP=two: no such figure group")


def test_pictures_are_compared_with_their_own_repository_and_files_are_as_they_were(made, tmp_path):
    """A hook of git names its repository to all that it runs; on Windows git may write other line ends."""
    picture = made.checkout / "figures" / "one" / "a.png"
    picture.parent.mkdir(parents=True)
    picture.write_text("one\n")
    shutil.copy(ROOT / ".gitattributes", made.checkout)
    commit(made.checkout)
    subprocess.run(["git", "clone", "-q", "-c", "core.autocrlf=true", made.checkout, tmp_path / "clone"], check=True)
    assert (tmp_path / "clone" / "figures" / "one" / "a.png").read_bytes() == b"one\n"
    of_a_hook = {"GIT_DIR": str(tmp_path), "GIT_WORK_TREE": str(tmp_path), "GIT_INDEX_FILE": str(tmp_path / "index")}
    _, out, err = made("figure", "GROUP=one", **of_a_hook)
    assert out.splitlines()[-1] == "figures/one/a.png (same as in git)", err


def commit(repository):
    """All files of a folder in a new repository."""
    somebody = ("-c", "user.name=somebody", "-c", "user.email=somebody@here")
    for words in ("init", "-q"), ("add", "."), ("commit", "-qm", "all"):
        subprocess.run(["git", *somebody, *words], cwd=repository, check=True)


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
        commit(repository)
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
