#!/usr/bin/python3
"""The manual page of isph, and the completion of its options in bash, made from README.md beside this file.

    manual.py > isph.1
    manual.py --completion > isph
"""
import os
import re
import sys

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "README.md"), encoding="utf-8") as file:
    README = file.read()

HEAD = r""".TH ISPH 1 "" "isph" "User Commands"
.SH NAME
isph \- incompressible smoothed particle hydrodynamics on PETSc
.SH SYNOPSIS
.B isph
.RI [ file.opts " ...] [" \-name
.RI [ value "]] ..."
.br
.B mpiexec \-n 4 isph
\&...
.SH DESCRIPTION
Simulates drops, splashes and other free-surface flows of liquids by particles. The scene and everything else are
options, on the command line or one a line in options files; what comes later wins. All units are SI. PETSc's own
options work as in any PETSc program: those of the pressure's solver without a prefix (\-ksp_type, \-pc_type),
\-log_view and others.
.PP
.B isph \-help
prints this list for the scene that is given.
"""

COMPLETION = """# Completion of isph's options in bash; written by options/manual.py.
_isph() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  case $before in
%s    -options_file|-restart|-dump_options|*_file|-output_dir) COMPREPLY=($(compgen -f -- "$word")); return ;;
  esac
  case $word in
    -*) COMPREPLY=($(compgen -W "%s $(_isph_bodies)" -- "$word")) ;;
    *)  COMPREPLY=($(compgen -f -- "$word")) ;;
  esac
}
# The options of the bodies, solids and regions that are named on the line, or in options files on it.
_isph_bodies() {
  local file body own text="${COMP_WORDS[*]}"
  for file in "${COMP_WORDS[@]}"; do
    if [[ $file == *.opts && -f $file ]]; then text+=" $(<"$file")"; fi
  done
  for body in $(grep -oE -- '-(bodies|solids|fine) +[^ ]+' <<< "$text" | sed 's/.* //; s/,/ /g'); do
    for own in %s; do echo "-${body}_$own"; done
  done
}
complete -o filenames -F _isph isph
"""


def groups():
    """[(title, [(names, default, unit, values, meaning)])] of the list of options."""
    found = []
    for line in README.split("<!-- options -->")[1].splitlines():
        if line.startswith("#"):
            found.append((line.lstrip("# "), []))
        elif line.startswith("| `-"):
            found[-1][1].append([cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip()[1:-1])])
    return [group for group in found if group[1]]


def plain(text):
    """Text for roff: no marks of markdown, no line that begins with a request."""
    text = re.sub(r"\[([^][]*)\]\([^()]*\)", r"\1", text).replace("`", "").replace("\\", "\\\\").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def page():
    """The manual page."""
    lines = [HEAD.rstrip()]
    for title, rows in groups():
        lines.append(".SH " + plain(title).upper())
        for names, default, unit, values, meaning in rows:
            facts = [f"default {default}" * bool(default), unit if unit != "1" else "", values]
            lines += [".TP", ".B " + plain(names),
                      plain(meaning) + "".join("; " + plain(fact) for fact in facts if fact) + "."]
    return "\n".join(lines)


def completion():
    """The completion: names, and the values of options that have a list of them."""
    names, bodies, choices = [], [], ""
    for _, rows in groups():
        for cells in rows:
            own = [name for name in re.findall(r"-[\w<>]+", cells[0]) if "<" not in name]
            names += own
            bodies += re.findall(r"-<body>_(\w+)", cells[0])
            if own and re.fullmatch(r"\w+(, \w+)+", cells[3]):
                words = cells[3].replace(",", "")
                choices += f"    {'|'.join(own)}) COMPREPLY=($(compgen -W \"{words}\" -- \"$word\")); return ;;\n"
    return COMPLETION % (choices, " ".join(names + ["-options_file", "-help", "-log_view", "-ksp_type", "-pc_type",
                                                    "-ksp_rtol", "-ksp_monitor"]),
                         " ".join(dict.fromkeys(bodies)))


if __name__ == "__main__":
    print(completion() if "--completion" in sys.argv[1:] else page())
