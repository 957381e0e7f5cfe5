#!/usr/bin/env python3
"""A server that speaks Azure's blobs, for tests: the blob service of Azurite, with a container `terrain`.

Prints its host and port, then puts files, as s3_server.py does. Ends with its input.

usage: azure_server.py FOLDER, in whose node_modules `azurite` is
"""
import base64
import email.utils
import hashlib
import hmac
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.request

# The account of development that every Azurite has: it is public and opens nothing else.
ACCOUNT = "devstoreaccount1"
KEY = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw=="
HEADERS = {"x-ms-version": "2023-11-03", "Content-Type": "application/octet-stream"}


def put(host, path, query, body, extra=()):
    """Puts a body by a request signed with the account's key."""
    headers = dict(sorted({**HEADERS, **dict(extra), "x-ms-date": email.utils.formatdate(usegmt=True)}.items()))
    own = "".join(f"{name}:{value}\n" for name, value in headers.items() if name.startswith("x-ms-"))
    parameters = "".join(f"\n{name}:{value}" for name, value in query)
    length = str(len(body)) if body else ""
    text = f"PUT\n\n\n{length}\n\n{HEADERS['Content-Type']}\n\n\n\n\n\n\n{own}/{ACCOUNT}/{ACCOUNT}/{path}{parameters}"
    signature = base64.b64encode(hmac.digest(base64.b64decode(KEY), text.encode(), hashlib.sha256)).decode()
    headers["Authorization"] = f"SharedKey {ACCOUNT}:{signature}"
    words = "&".join(f"{name}={value}" for name, value in query)
    url = f"http://{host}/{ACCOUNT}/{path}" + (f"?{words}" if words else "")
    urllib.request.urlopen(urllib.request.Request(url, body, headers, method="PUT"), timeout=60).close()


with tempfile.TemporaryDirectory() as folder:
    program = pathlib.Path(sys.argv[1]) / "node_modules/azurite/dist/src/blob/main.js"
    command = ["node", program, "--blobHost", "127.0.0.1", "--blobPort", "0", "--inMemoryPersistence", "--disableTelemetry"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder) as server:
        try:
            found = (re.search(r"successfully listen\w* (?:at|on) http://(\S+)", line) for line in server.stdout)
            host = next(match[1] for match in found if match)
            put(host, "terrain", [("restype", "container")], b"")
            print(host, flush=True)
            for line in sys.stdin:
                path, key = line.rstrip("\n").split("\t")
                if path == "done":
                    pathlib.Path(key).touch()
                else:
                    put(host, f"terrain/{key}", [], pathlib.Path(path).read_bytes(), [("x-ms-blob-type", "BlockBlob")])
        finally:
            server.kill()
