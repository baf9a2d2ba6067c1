#!/bin/sh
# Stands in for the program in tests: some shares are killed once, at a random moment and without warning (SIGKILL); started again they
# run to their end.
#
#   FARM_PROGRAM the program; FARM_KILLS how many shares die; FARM_SPAN until when, seconds; FARM_STATE a folder, whose
#   killed/1, killed/2, … are those that did.
for argument; do
    case $before in
    --shard | --frames) share=$argument ;;
    esac
    before=$argument
done
[ "$share" = env ] && share="$SLURM_ARRAY_TASK_ID"
name=$(echo "$share" | tr -c '0-9\n' _)
mkdir -p "$FARM_STATE/started" "$FARM_STATE/killed"
mkdir "$FARM_STATE/started/$name" 2>/dev/null || exec "$FARM_PROGRAM" "$@"
death=1
until mkdir "$FARM_STATE/killed/$death" 2>/dev/null; do
    death=$((death + 1))
    [ "$death" -le "$FARM_KILLS" ] || exec "$FARM_PROGRAM" "$@"
done
"$FARM_PROGRAM" "$@" &
pid=$!
sleep "$(awk -v seed="$pid" -v span="$FARM_SPAN" 'BEGIN { srand(seed); print span * rand() }')"
kill -KILL "$pid" 2>/dev/null
wait "$pid"
code=$?
# Who was through before is not among the killed.
[ "$code" = 137 ] || rmdir "$FARM_STATE/killed/$death"
exit "$code"
