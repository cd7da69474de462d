#!/usr/bin/env bash
# Turns the links of installed documents that lead to no installed file into plain text: sources are not installed. The
# path follows the text unless the text names it.
#   bash cmake/plain_links.sh FOLDER...     changes the Markdown files below these folders
set -euo pipefail

find "$@" -name '*.md' -print0 | xargs -0 perl -0777 -e '
  use File::Basename;
  sub plain {
    my ($text, $path) = @_;
    $path =~ s{^(\.\./)+}{};
    my $name = $path =~ s{/README\.md$}{}r =~ s{\.\w+$}{}r; # as texts write it: without README.md or extension
    return index($text, basename($name)) >= 0 ? $text : "$text, $path";
  }
  for my $file (@ARGV) {
    open(my $in, "<", $file) or die "$file: $!\n";
    my $text = my $before = <$in>;
    my $folder = dirname($file);
    # [text](target#part): a target with a scheme and a mere #part lead elsewhere
    $text =~ s{(!?)\[([^][]*)\]\((?![a-z]+:|#)([^()\s#]+)(#[^()\s]*)?\)}{-e "$folder/$3" ? $& : plain($2, $3)}ge;
    next if $text eq $before;
    open(my $out, ">", $file) or die "$file: $!\n";
    print $out $text;
  }'
