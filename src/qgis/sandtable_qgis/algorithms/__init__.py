"""Algorithms of Processing: one runs one command of the program."""
