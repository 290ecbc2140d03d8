#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# out_of_memory_test.sh DEVEL [MB...]: the node under ten limits of its address space. Whether it cannot start, loses pairs or has
# enough, it says what is wrong and no signal ends it.
export MALLOC_ARENA_MAX="${MALLOC_ARENA_MAX:-2}" # an arena reserves 64 MB of addresses
# shellcheck source=test/ros/own_master.sh
. "$(dirname "${BASH_SOURCE[0]}")/own_master.sh" "$1"
start_master

rosbag play -q -l "$1/share/fdp_stereo/sample/motorcycle.bag" </dev/null >"$work/play.log" 2>&1 &
rostopic hz /stereo/disparity </dev/null >"$work/reader.log" 2>&1 &

# Until the node has ended, failed with a pair, or given one.
settled() {
  ! kill -0 "$node" 2>/dev/null || grep -q 'memory' "$work/node.log" || grep -q 'average rate' "$work/reader.log"
}
failed=0
lost=0
limits=("${@:2}")
[ "${#limits[@]}" -gt 0 ] || limits=(150 200 230 260 280 300 320 340 400 4000)
for megabytes in "${limits[@]}"; do
  : >"$work/reader.log"
  ROS_NAMESPACE=stereo bash -c "ulimit -v $((megabytes * 1024)); exec \"\$0\" \"\$@\"" \
    "$1/lib/fdp_stereo/disparity_node" left/image_rect:=left/image_raw right/image_rect:=right/image_raw \
    </dev/null >"$work/node.log" 2>&1 &
  node=$!
  for _ in $(seq 300); do
    if settled; then break; fi
    sleep 0.1
  done
  settled || { echo "$megabytes MB: neither a disparity nor a message" >&2; failed=1; }
  said="$(grep -iE 'memory|ended|alloc|resource|cannot|failed|libgomp' "$work/node.log" | tail -n 1 || true)"
  code=0
  if kill -INT "$node" 2>/dev/null; then ended="stopped by the test"; else ended="ended by itself"; fi
  wait "$node" || code=$?
  echo "$megabytes MB: $ended, exit code $code. $said"
  if [ "$code" -gt 1 ] && [ "$code" -ne 127 ]; then
    echo "$megabytes MB: ended by a signal or an unknown error" >&2
    cat "$work/node.log" >&2
    failed=1
  fi
  if [ "$ended" = "ended by itself" ] && [ -z "$said" ]; then
    echo "$megabytes MB: ended without a message" >&2
    cat "$work/node.log" >&2
    failed=1
  fi
  if [ -n "$said" ]; then lost=$((lost + 1)); fi
done
grep -q 'average rate' "$work/reader.log" || { echo "no disparity with 4000 MB" >&2; failed=1; }
[ "$lost" -ge 3 ] || { echo "the limits are too wide to show anything" >&2; failed=1; }
exit "$failed"
