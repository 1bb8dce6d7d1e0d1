# SPDX-License-Identifier: Apache-2.0
"""The journal of a world: files from which it goes on after a crash. Knows the engine, but no world.

records: the bytes of a file. folder: the files, and who may write them. writer: the thread that writes. reader: the
newest good state in a folder, and how it gets into a system.
"""
