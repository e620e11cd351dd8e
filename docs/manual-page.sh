#!/bin/sh
# Writes a manual page: of one command from its sections of the command reference, or, without a
# command, wirebench(1), which lists the commands. The one-line summaries come from the table of the
# tool. Usage: manual-page.sh LOWDOWN REFERENCE.md COMMANDS OUTPUT [COMMAND]
# where COMMANDS is the output of `wirebench --complete ''`.
set -eu
lowdown=$1 reference=$2 commands=$3 output=$4 command=${5:-}
page=wirebench${command:+-$command}

awk -v command="$command" -v page="$page" '
    FNR == NR { # "record<TAB>run a bending test ..."
        split($0, part, "\t")
        if (part[1] !~ /^-/) {
            names[++n] = part[1]
            summary[part[1]] = part[2]
        }
        next
    }
    # Options and words with their text, "* `--json`: text", and rows of tables of two columns become
    # definitions.
    function put(line) {
        if (line ~ /^\| /) {
            if (rows++ > 1) { # behind the head and its rule
                split(line, cell, / *\| */)
                print "\n" cell[2] "\n\n:   " cell[3]
            }
            return
        }
        rows = 0
        if (line ~ /^\* `/ && match(line, /`: /)) {
            # The colon behind the last of several: "`-o`, `--output=DIR`: folder to write"
            print ""
            print substr(line, 3, RSTART - 2)
            print ""
            print ":   " substr(line, RSTART + RLENGTH)
            defines = 1
            return
        }
        if (defines && line ~ /^  [^ ]/) {
            print "  " line
            return
        }
        defines = 0
        print line
    }
    # "### Exit status" and "### Examples" of all sections of a command stand at the end of its page.
    function end_of_page(name, text) {
        if (text != "")
            print "# " name "\n" text
    }
    function list() {
        print "# COMMANDS"
        for (i = 1; i <= n; i++)
            printf "\n`wirebench-%s`(1)\n\n:   %s\n", names[i], summary[names[i]]
        print ""
    }
    # The section of a command, and those of its kinds ("## calibrate --tensile").
    command && /^## / {
        part_name = ""
        inside = $2 == command && (NF == 2 || $3 ~ /^--/)
        if (inside && NF == 2) {
            found = 1
            print "# NAME\n\n" page " - " summary[command] "\n\n# SYNOPSIS"
            synopsis = 1
        } else if (inside) {
            print "# " toupper(substr($0, 4))
        }
        next
    }
    /^# / {
        part_name = ""
        inside = !command && $0 !~ /^# COMMANDS (AT|ON)/
        if (!command && /^# EXIT STATUS/)
            list()
    }
    /^## / { inside = 0 }
    inside && /^### / {
        part_name = toupper(substr($0, 5))
        next
    }
    inside && part_name {
        if (part_name == "EXIT STATUS" && /^\| [0-9]/) {
            split($0, cell, / *\| */)
            codes = codes "\n" cell[2] "\n\n:   " cell[3] "\n"
        } else if (part_name == "EXIT STATUS" && $0 !~ /^\|/) {
            codes = codes "\n" $0
        } else if (part_name == "EXAMPLES") {
            examples = examples "\n" $0
        }
        next
    }
    inside {
        if (synopsis && NF && $0 !~ /^`wirebench /) {
            print "# DESCRIPTION\n"
            synopsis = 0
        }
        put($0)
    }
    END {
        if (command && (!found || !(command in summary))) {
            print "no section or summary of the command " command >"/dev/stderr"
            exit 1
        }
        if (command && (codes == "" || examples == "")) {
            print "no exit status or examples of the command " command >"/dev/stderr"
            exit 1
        }
        end_of_page("EXIT STATUS", codes)
        end_of_page("EXAMPLES", examples)
        if (command)
            print "# SEE ALSO\n\n`wirebench`(1)"
    }' "$commands" "$reference" >"$output.md"
"$lowdown" -s -t man --nroff-nolinks --out-no-smarty -M title="$(echo "$page" | tr '[:lower:]' '[:upper:]')" \
    -M section=1 -o "$output" "$output.md"
rm "$output.md"
