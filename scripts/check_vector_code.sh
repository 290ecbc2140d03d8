#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_vector_code.sh OBJECT...: fails where a function of the arm64 kernels (src/core/simd/*_kernels.cpp.o of a build)
# has no vector instructions, or a hot one not those that it is made of. OBJDUMP names the disassembler.
set -euo pipefail
[ "$#" -gt 0 ] || { echo "usage: check_vector_code.sh OBJECT..." >&2; exit 2; }

# Instructions per function. Those below 40 call or jump to others; a table or the size of a buffer needs no vectors.
"${OBJDUMP:-objdump}" -dC --no-show-raw-insn "$@" | awk '
  BEGIN {
    needs["thetaCosts"] = "umull"; needs["addCensusCosts"] = "tbl"; needs["hamming"] = "cnt"
    needs["absoluteDifferences"] = "umin"; needs["convolve"] = "smull"; needs["sumAlongColumns"] = "fabd"
    needs["followOf"] = "umin"; needs["relaxRow"] = "fcmgt"; needs["addNeighbour"] = "fmul"
  }
  function check(  key) {
    if (name == "") return
    if (all >= 40 && vectors < 5) { print "check_vector_code.sh: " name " has " vectors " vector instructions of " all; bad = 1 }
    for (key in needs) {
      if (name !~ "::" key "[<(]") continue
      seen[key] = 1
      if (!(needs[key] in mnemonics)) { print "check_vector_code.sh: " name " has no " needs[key]; bad = 1 }
    }
  }
  /^[0-9a-f]+ <.*>:$/ { check(); name = $0; sub(/^[0-9a-f]+ </, "", name); sub(/>:$/, "", name); all = 0; vectors = 0; delete mnemonics; count++; next }
  /^ *[0-9a-f]+:/ { all++; if ($0 ~ /[ ,{]v[0-9]+\.(16b|8b|8h|4h|4s|2s|2d)/) { vectors++; mnemonics[$2] = 1 } }
  END {
    check()
    for (key in needs) if (!(key in seen)) { print "check_vector_code.sh: no function " key; bad = 1 }
    if (!bad) print "check_vector_code.sh: " count " functions, vectors where they belong"
    exit bad
  }'
