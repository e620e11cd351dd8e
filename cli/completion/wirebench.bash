# Completion of wirebench for bash. The tool itself prints the candidates (cli/complete.h).
_wirebench() {
    local words candidates word
    # bash splits words at '=' and ':', the tool expects them unsplit.
    read -ra words <<<"${COMP_LINE:0:COMP_POINT}"
    [[ ${COMP_LINE:0:COMP_POINT} != *[[:space:]] ]] || words+=('')
    word=${words[${#words[@]} - 1]}
    mapfile -t candidates < <("${words[0]}" --complete "${words[@]:1}" 2>/dev/null)
    COMPREPLY=("${candidates[@]%%$'\t'*}")
    # The text before the last '=' is on the line already.
    [[ $word != *=* ]] || COMPREPLY=("${COMPREPLY[@]#"${word%%=*}="}")
    [[ ${#COMPREPLY[@]} -ne 1 || ${COMPREPLY[0]} != *= ]] || compopt -o nospace 2>/dev/null
}
complete -o default -F _wirebench wirebench
