# fish completion of `swingbank`. from_help.sh writes the lines of the commands and their options.
# ---
# Returns whether the first word after the program name is the argument; without an argument, whether there is no word.
function __swingbank_words
    set -l words (commandline -opc)[2..-1]
    test (count $argv) -eq 0 -a (count $words) -eq 0
    or test (count $argv) -gt 0 -a (count $words) -gt 0 -a "$words[1]" = "$argv[1]"
end
complete -c swingbank -n __swingbank_words -f
complete -c swingbank -n __swingbank_words -l version -d 'print version and commit'
complete -c swingbank -n __swingbank_words -l help -d 'list the commands'
complete -c swingbank -n __swingbank_words -a help -d 'help of a command'
complete -c swingbank -n '__swingbank_words help' -f
