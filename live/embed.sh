#!/bin/sh
# Writes a file as a C array. Usage: embed.sh INPUT OUTPUT NAME
set -eu
{
    echo "/* Generated from $(basename "$1") by embed.sh. */"
    echo "static const unsigned char $3[] = {"
    od -An -v -tx1 "$1" | sed 's/\([0-9a-f][0-9a-f]\)/0x\1,/g'
    echo "};"
} >"$2"
