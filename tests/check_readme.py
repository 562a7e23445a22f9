#!/usr/bin/env python3
"""Runs the commands that the documents show, and looks up every option that they mention.

    check_readme.py PROGRAM              all *.md files of the sources
    check_readme.py PROGRAM --self-test  the rules, on documents with mistakes in them

A block of commands is fenced by ```sh. Each of its lines is run, `./tool/run`, `softreel` and `build/tool/softreel` standing
for PROGRAM, in a temporary folder that sees assets/, presets/ and tests/; it must end with status 0. To be cheap, commands
that make pictures get the settings SMALL after their own, and at most two frames where they name none.
A block that cannot be run stands under a comment that says why, `<!-- not run: REASON -->`: it is counted, and its options
are looked up all the same. A ```toml block with a `schema` must pass `softreel check`.

In the text, `softreel COMMAND --option` must be a command with that option, `--option` alone one of any command or of tool/test,
and the path of `--set PATH=VALUE` a field. All of it comes from the program: `softreel completion json`, `softreel explain`.
"""
import json
import os
import re
import resource
import shlex
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAM_WORDS = ("./tool/run", "softreel", "build/tool/softreel")
PICTURES = ("render", "sheet", "preview", "batch", "golden")
SMALL = ["render.width=160", "render.height=90", "render.samples=1", "render.max_bounces=1", "solver.substeps=1"]
NOT_RUN = re.compile(r"<!--\s*not run:\s*(.*?)\s*-->")
EXAMPLE_PATH = re.compile(r"^(PATH|FIELD|key|body\.NAME\..*)$")


class Table:
    """Commands, options and fields, as the program itself has them."""

    def __init__(self, program):
        self.program = program
        table = json.loads(self.ask("completion", "json"))
        self.commands = {command["name"]: self.names(command) for command in table["commands"]}
        self.own = self.names(table["program"])
        self.fields = {}
        with open(os.path.join(ROOT, "tool", "test"), encoding="utf-8") as f:
            self.test_options = set(re.findall(r"--[a-z-]+", f.read()))

    def ask(self, *arguments):
        return subprocess.run((self.program,) + arguments, check=True, capture_output=True, text=True).stdout

    @staticmethod
    def names(command):
        return {name for option in command["options"] for name in option["names"]} | {"--help"}

    def has_field(self, path):
        if path not in self.fields:
            ran = subprocess.run([self.program, "explain", path], capture_output=True)
            self.fields[path] = ran.returncode == 0
        return self.fields[path]


class Block:
    """A fenced block with the line where it begins and the reason why it is not run, if there is one."""

    def __init__(self, language, line, reason):
        self.language, self.line, self.reason, self.lines = language, line, reason, []


def parts_of(text):
    """The fenced blocks of a document, and its other lines with their numbers."""
    blocks, prose, block, reason = [], [], None, None
    for number, line in enumerate(text.splitlines(), 1):
        fence = re.match(r"\s*```(\w*)", line)
        if fence and block is None:
            block = Block(fence.group(1), number, reason)
            blocks.append(block)
        elif fence:
            block = reason = None
        elif block is not None:
            block.lines.append((number, line))
        else:
            found = NOT_RUN.search(line)
            if found:
                reason = found.group(1)
            elif line.strip():
                reason = None
            prose.append((number, line))
    return blocks, prose


def words_of(text):
    try:
        return shlex.split(text, comments=True)
    except ValueError:  # a lone quote: part of a sentence
        return text.split()


def option_problems(words, table):
    """What is wrong with a command or with options alone: words that the program would not take."""
    known, where = set(), "no command"
    rest = words
    if words and words[0] in PROGRAM_WORDS:
        rest = words[1:]
        if not rest or rest[0].endswith(".toml") or rest[0] in ("...", "ARGUMENTS"):
            known, where = table.commands["render"], "softreel render"
        elif rest[0].startswith("-"):
            known, where = table.own, "softreel"
        elif rest[0] in table.commands:
            known, where = table.commands[rest[0]], "softreel " + rest[0]
        elif rest[0].isupper():
            known = set().union(*table.commands.values(), table.own)
        else:
            return ["softreel has no command %s" % rest[0]]
    elif words and words[0] in ("./tool/test", "tool/test"):
        known, where = table.test_options, "tool/test"
    elif words and words[0].startswith("--"):
        known = set().union(*table.commands.values(), table.own, table.test_options)
    else:
        return []
    found = []
    for i, word in enumerate(rest):
        name = word.split("=")[0]
        if re.match(r"^--?[a-z]", name) and name not in known:
            found.append("%s has no option %s" % (where, name))
        if name == "--set" and i + 1 < len(rest) and "=" in rest[i + 1]:
            path = rest[i + 1].split("=")[0].strip("'\"")
            if not EXAMPLE_PATH.match(path) and not table.has_field(path):
                found.append("a shot has no field %s" % path)
    return found


def small(arguments):
    """The same command, cheap (see above)."""
    command = arguments[0]
    if command not in PICTURES or "--dry-run" in arguments or "--help" in arguments:
        return arguments
    more = [word for setting in SMALL for word in ("--set", setting)]
    if "--frames" not in arguments and command in ("render", "preview", "batch"):
        more += ["--frames", "1-2"]
    return arguments + more


class Check:
    def __init__(self, program):
        self.program = os.path.abspath(program)
        self.table = Table(self.program)
        self.folder = tempfile.TemporaryDirectory()
        for name in ("assets", "presets", "tests"):
            os.symlink(os.path.join(ROOT, name), os.path.join(self.folder.name, name))
        os.mkdir(os.path.join(self.folder.name, "shots"))
        os.symlink(os.path.join(ROOT, "presets", "materials"), os.path.join(self.folder.name, "shots", "materials"))
        self.ran = self.not_run = self.mentions = 0
        self.problems = []

    def run(self, place, arguments):
        self.ran += 1
        if arguments and arguments[0].endswith(".toml"):
            arguments = ["render"] + arguments
        run = subprocess.run([self.program] + small(arguments), cwd=self.folder.name, capture_output=True, text=True)
        if run.returncode != 0:
            self.problems.append("%s: softreel %s: status %d\n%s" % (place, " ".join(arguments), run.returncode, run.stderr))

    def commands(self, path, block):
        for number, line in block.lines:
            words, place = words_of(line), "%s:%d" % (path, number)
            if not words:
                continue
            found = option_problems(words, self.table)
            self.problems += ["%s: %s" % (place, problem) for problem in found]
            if block.reason:
                self.not_run += 1
            elif words[0] not in PROGRAM_WORDS or len(words) == 1:
                self.problems.append("%s: %s cannot be run here: say why in <!-- not run: REASON --> above" % (place, line))
            elif not found:
                self.run(place, words[1:])

    def shot(self, path, block):
        text = "\n".join(line for _, line in block.lines)
        if not re.search(r"^schema\s*=", text, re.MULTILINE) or block.reason:
            return
        shot = os.path.join("shots", "block_%d.toml" % block.line)
        with open(os.path.join(self.folder.name, shot), "w", encoding="utf-8") as f:
            f.write(text + "\n")
        self.run("%s:%d" % (path, block.line), ["check", shot])

    def document(self, path, text):
        blocks, prose = parts_of(text)
        for block in blocks:
            if block.language == "sh":
                self.commands(path, block)
            elif block.language == "toml":
                self.shot(path, block)
            elif any(words_of(line)[:1] and words_of(line)[0] in PROGRAM_WORDS for _, line in block.lines):
                self.problems.append("%s:%d: a block of commands begins with ```sh" % (path, block.line))
        for number, line in prose:
            for span in re.findall(r"`([^`]+)`", line.replace("\\|", "|")):
                words = words_of(span)
                self.mentions += bool(words) and (words[0] in PROGRAM_WORDS or words[0].startswith("--"))
                for problem in option_problems(words, self.table):
                    self.problems.append("%s:%d: `%s`: %s" % (path, number, span, problem))


def documents():
    # Of a checkout that another user owns too, as in a container with a mounted folder.
    listed = subprocess.run(["git", "-c", "safe.directory=*", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT,
                            check=True, stdout=subprocess.PIPE, text=True).stdout
    return [path for path in listed.splitlines() if os.path.exists(os.path.join(ROOT, path))]


MISTAKES = [
    ("an unknown option of a block", "```sh\nsoftreel check presets/first_pull.toml --farmes 1\n```\n"),
    ("an unknown option in the text", "Say `--farmes 1-4` for that.\n"),
    ("an option of another command", "`softreel check SHOT --wireframe` draws.\n"),
    ("an unknown command", "`softreel rendr SHOT` renders.\n"),
    ("an unknown field", "Use `--set render.sampels=4`.\n"),
    ("a command that fails", "```sh\nsoftreel check presets/no_such_shot.toml\n```\n"),
    ("a block that cannot be run and does not say so", "```sh\nmake coffee\n```\n"),
    ("commands in a block of another kind", "```\nsoftreel fields\n```\n"),
    ("a shot with a mistake", "```toml\nschema = 1\n[body.a]\nmehs = \"x.ply\"\n```\n"),
    ("an unknown option in a block that is not run", "<!-- not run: slow -->\n```sh\nsoftreel render SHOT --farmes 1\n```\n"),
]
SOUND = ("Say `--frames 1-4`, `softreel render SHOT --set render.samples=4` or `--set PATH=VALUE`.\n"
         "```sh\nsoftreel explain tets  # a comment\n```\n<!-- not run: it is slow -->\n\n```sh\n./tool/test --fast\n```\n")


def self_test(program):
    wrong = []
    for what, text in MISTAKES:
        check = Check(program)
        check.document("x.md", text)
        if len(check.problems) != 1:
            wrong.append("%s: %d problems instead of one: %s" % (what, len(check.problems), check.problems))
    check = Check(program)
    check.document("x.md", SOUND)
    if check.problems or (check.ran, check.not_run, check.mentions) != (1, 1, 3):
        wrong.append("a sound document: %s %d %d %d" % (check.problems, check.ran, check.not_run, check.mentions))
    print("\n".join(wrong + ["rules: %d documents, %d wrong" % (len(MISTAKES) + 1, len(wrong))]))
    return 1 if wrong else 0


def main():
    if sys.argv[2:] == ["--self-test"]:
        return self_test(sys.argv[1])
    check = Check(sys.argv[1])
    for path in documents():
        with open(os.path.join(ROOT, path), encoding="utf-8") as f:
            check.document(path, f.read())
    for problem in check.problems:
        print(problem)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print("documents: %d commands run, %d marked as not run, %d mentions looked up, %d problems; %.0f cpu s" %
          (check.ran, check.not_run, check.mentions, len(check.problems), used.ru_utime + used.ru_stime))
    return 1 if check.problems or check.ran == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
