# SPDX-License-Identifier: GPL-3.0-or-later
# zsh complete.zsh SCRIPTS PROGRAMS LINE...: what an interactive zsh that knows the completion scripts of one folder and
# the programs of another makes of each line when Tab is pressed behind it, one line each.
zmodload zsh/zpty zsh/zselect
scripts=$1 programs=$2
shift 2
answer=$PWD/answer.$$
zpty shell zsh -f -i
zpty -w shell "PS1= PS2=; path=(${(q)programs} \$path); fpath=(${(q)scripts} \$fpath); autoload -Uz compinit; compinit -D -u"
zpty -w shell "tell() { print -r -- \"\$BUFFER\" >${(q)answer}.part; mv ${(q)answer}.part ${(q)answer}; BUFFER=; zle .accept-line }"
zpty -w shell "zle -N tell; bindkey '^X' tell; bindkey '^I' complete-word; unsetopt beep autolist automenu"
zpty -w shell "print are you' 'ready"
zpty -r shell line '*are you ready*'
for line in "$@"; do
    rm -f $answer
    zpty -w -n shell "$line"$'\t\x18'
    for try in {1..1000}; do
        [[ -e $answer ]] && break
        zselect -t 2
    done
    print -r -- "$(<$answer)"
done
rm -f $answer
zpty -d shell
