#!/usr/bin/python3
"""The manual page of isph, and the completion of its options in bash, made from options.json beside this file, which
isph -options_json writes.

    manual.py > isph.1
    manual.py --completion > isph
"""
import json
import os
import sys

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "options.json"), encoding="utf-8") as file:
    KNOWN = json.load(file)
OWNER, FACE = "<body>", "<face>"
FACES = ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")

HEAD = r""".TH ISPH 1 "" "isph" "User Commands"
.SH NAME
isph \- incompressible smoothed particle hydrodynamics on PETSc
.SH SYNOPSIS
.B isph
.RB [ \-ranks
.IR N ]
.RI [ file.opts " ...] [" \-name
.RI [ value "]] ..."
.SH DESCRIPTION
Simulates drops, splashes and other free-surface flows of liquids by particles. The scene and everything else are
options, on the command line or one a line in options files; what comes later wins. Numbers are in the unit that the
list gives; others may stand behind them (0.1mm, 40deg, 3cP). PETSc's own
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
%s    -options_file|-restart|-dump_options|*_json|*_file|-output_dir) COMPREPLY=($(compgen -f -- "$word")); return ;;
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


def plain(text):
    """Text for roff: no line that begins with a request."""
    text = text.replace("\\", "\\\\").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def page():
    """The manual page."""
    lines, title = [HEAD.rstrip()], None
    for option in KNOWN["options"]:
        if option["group"] != title:
            title = option["group"]
            lines.append(".SH " + plain(title).upper())
        facts = [f"default {option['default']}" * bool(option["default"]),
                 option["unit"] if option["unit"] != "1" else "",
                 option["range"] or ", ".join(option.get("values", []))]
        lines += [".TP", ".B " + plain(option["name"]),
                  plain(option["meaning"]) + "".join("; " + plain(fact) for fact in facts if fact) + "."]
    lines.append(".SH WHAT CANNOT BE USED TOGETHER")
    for refusal in KNOWN["refusals"]:
        lines += [".PP", plain(f"{refusal['one']} {refusal['relation']} {refusal['other']}{refusal['rest']}") + "."]
    return "\n".join(lines)


def completion():
    """The completion: names, and the values of options that have a list of them."""
    names, bodies, choices = [], [], ""
    for option in KNOWN["options"]:
        name, values = option["name"], option.get("values", ["true", "false"] if option["kind"] == "bool" else [])
        if option["owner"] == OWNER:
            bodies.append(name.removeprefix(f"-{OWNER}_"))
            continue
        own = list(dict.fromkeys(name.replace(FACE, face).replace("<axis>", face[0]) for face in FACES))
        names += own
        if values:
            listed = f"COMPREPLY=($(compgen -W \"{' '.join(values)}\" -- \"$word\"))"
            choices += f"    {'|'.join(own)}) {listed}; return ;;\n"
    return COMPLETION % (choices, " ".join([*dict.fromkeys(names), "-options_file", "-help", "-log_view", "-ksp_type",
                                            "-pc_type", "-ksp_rtol", "-ksp_monitor"]), " ".join(dict.fromkeys(bodies)))


if __name__ == "__main__":
    print(completion() if "--completion" in sys.argv[1:] else page())
