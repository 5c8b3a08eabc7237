#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Counts the test cases in meson's testlog.json and prints one line: N passed, N failed, N skipped.

Tests that speak TAP count case by case, others as one. A test that ends badly without a failed case of its own (crash, time
limit, cases missing from its plan) counts as one failure. A case that could not run prints "# skipped: WHY" and counts as skipped.

Real captures: when ../shared/data is there, a case that was skipped for want of it is a failure.
"""
import argparse
import json
import os
import re
import sys

BAD = {'FAIL', 'ERROR', 'TIMEOUT', 'INTERRUPT', 'UNEXPECTEDPASS'}


def count(test):
    """(passed, failed, reasons of the skipped) of one entry of the log."""
    out = (test.get('stdout') or '') + '\n'
    result = test['result']
    passed = failed = 0
    reasons = re.findall(r'^# skipped: (.*)$', out, re.M)
    plan = re.search(r'^1\.\.(\d+)(?:\s*# *skip(?:ped)?:?\s*(.*))?$', out, re.M | re.I)
    if not plan:
        if result in BAD:
            return 0, 1, reasons
        return (0, 0, reasons or [test['name']]) if result == 'SKIP' else (1, 0, reasons)
    for line in re.findall(r'^(?:not )?ok\b.*$', out, re.M):
        skip = re.search(r'# *skip\S*\s*(.*)$', line, re.I)
        if skip:
            reasons.append(skip.group(1) or test['name'])
        elif line.startswith('not'):
            failed += 1
        else:
            passed += 1
    if plan.group(1) == '0':
        reasons.append(plan.group(2) or test['name'])
    passed -= len(re.findall(r'^# skipped: ', out, re.M))  # such a case says ok as well
    if result in BAD and not failed:
        failed = 1
    return passed, failed, reasons


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('log')
    parser.add_argument('--status', type=int, default=0, help='exit status of meson test')
    parser.add_argument('--data', help='folder of the real captures',
                        default=os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'shared', 'data'))
    args = parser.parse_args()
    passed = failed = skipped = 0
    try:
        with open(args.log, encoding='utf-8', errors='replace') as log:
            tests = [json.loads(line) for line in log if line.strip()]
    except OSError as error:
        print(f'no test log: {error}')
        tests, failed = [], 1
    for test in tests:
        p, f, reasons = count(test)
        passed += p
        failed += f
        skipped += len(reasons)
        for reason in reasons:
            print(f"skipped: {test['name']}: {reason}")
        if reasons and os.path.isdir(args.data):
            print(f"{test['name']}: the real captures are in {args.data}: nothing may be skipped")
            failed += 1
    if args.status and not failed:
        failed = 1  # meson itself failed
    if not args.status and passed + failed + skipped == 0:
        print('no test ran')
        failed = 1
    print(f'{passed} passed, {failed} failed, {skipped} skipped')
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
