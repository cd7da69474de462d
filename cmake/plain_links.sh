#!/usr/bin/env bash
# Replaces links in installed documents by plain text if their target is not installed, such as a source file. The path
# follows the link text unless the text contains it.
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
    # [text](target#part); excludes targets with a scheme and targets that are only a #part, because they are not files
    $text =~ s{(!?)\[([^][]*)\]\((?![a-z]+:|#)([^()\s#]+)(#[^()\s]*)?\)}{-e "$folder/$3" ? $& : plain($2, $3)}ge;
    next if $text eq $before;
    open(my $out, ">", $file) or die "$file: $!\n";
    print $out $text;
  }'
