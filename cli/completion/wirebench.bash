# Completion of wirebench for bash. The tool itself says what may come next (cli/complete.h).
_wirebench() {
    local words candidates word
    # bash splits words at '=' and ':', the tool wants them whole.
    read -ra words <<<"${COMP_LINE:0:COMP_POINT}"
    [[ ${COMP_LINE:0:COMP_POINT} != *[[:space:]] ]] || words+=('')
    word=${words[${#words[@]} - 1]}
    mapfile -t candidates < <("${words[0]}" --complete "${words[@]:1}" 2>/dev/null)
    COMPREPLY=("${candidates[@]%%$'\t'*}")
    # What stands before the last '=' is on the line already.
    [[ $word != *=* ]] || COMPREPLY=("${COMPREPLY[@]#"${word%%=*}="}")
    [[ ${#COMPREPLY[@]} -ne 1 || ${COMPREPLY[0]} != *= ]] || compopt -o nospace 2>/dev/null
}
complete -o default -F _wirebench wirebench
