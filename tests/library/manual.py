"""Runs a chapter of the manual in an empty folder, as a new user would.

A fenced block that begins with a comment `# NAME` is the file of that name. Indented blocks are run by
bash, and must succeed. Each line of a `text` block must stand in the output of the commands before it,
with any numbers in place of those printed; a line may be cut off at its end.

Usage: manual.py WIREBENCH SOURCE_ROOT CHAPTER
"""

import os
import re
import subprocess
import sys
import tempfile

WIREBENCH, SOURCE, CHAPTER = sys.argv[1:]


def blocks():
    """Kind and text of each block of the chapter: "" for commands, otherwise that of the fence."""
    with open(os.path.join(SOURCE, "docs", "manual.md")) as file:
        chapter = re.search(r"^## %s\n(.*?)^## " % CHAPTER, file.read(), re.M | re.S).group(1)
    pattern = r"^```(\w+)\n(.*?)^```$|(?<=\n\n)((?:    [^\n]*\n)+)"
    for kind, fenced, indented in re.findall(pattern, chapter, re.M | re.S):
        yield kind, fenced or re.sub(r"^    ", "", indented, flags=re.M)


def plain(line):
    return re.sub(r"[ #]+", " ", re.sub(r"-?\d+(\.\d+)?(e[+-]?\d+)?", "#", line)).strip()


def run(folder, commands):
    done = subprocess.run(["bash", "-e", "-c", commands], cwd=folder, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, "%s\nends with %d:\n%s" % (commands, done.returncode, done.stdout[-2000:])
    return done.stdout


def main():
    n_commands, n_lines, said = 0, 0, ""
    with tempfile.TemporaryDirectory() as top:
        folder, programs = os.path.join(top, "work"), os.path.join(top, "bin")
        os.mkdir(folder)
        os.mkdir(programs)
        os.symlink(os.path.realpath(WIREBENCH), os.path.join(programs, "wirebench"))
        os.symlink(sys.executable, os.path.join(programs, "python3"))
        os.environ["PATH"] = programs + os.pathsep + os.environ["PATH"]
        os.environ["WIREBENCH_DATA"] = SOURCE
        for kind, text in blocks():
            name = re.match(r"# (\S+)\n", text)
            if kind == "":
                said = run(folder, text)
                n_commands += 1
            elif kind == "text":
                lines = [plain(line) for line in said.splitlines()]
                for line in text.splitlines():
                    n_lines += 1
                    assert any(plain(line) in other for other in lines), "'%s' is not in\n%s" % (line, said[-4000:])
            elif name:
                with open(os.path.join(folder, name.group(1)), "w") as file:
                    file.write(text[name.end():])
    assert n_commands > 0, "no commands in the chapter"
    print("%d blocks of commands, %d lines of output" % (n_commands, n_lines))


main()
