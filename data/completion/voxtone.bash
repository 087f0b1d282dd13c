# SPDX-License-Identifier: GPL-3.0-or-later
# bash completion for voxtone: the program itself says what may stand next; where it says nothing, files may.
_voxtone() {
    local IFS=$'\n'
    COMPREPLY=($("${COMP_WORDS[0]/#\~/$HOME}" complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
}
complete -o default -o bashdefault -F _voxtone voxtone
