#!/usr/bin/env python3
"""A web server for tests, which sends parts of the files in a folder: plain, or encrypted with a certificate made for the run.

Prints its host and port. With a second folder it speaks TLS, and writes there, before that, `authority.pem`, which signed its
certificate for 127.0.0.1, and `stranger.pem`, an authority that signed nothing. Ends when its input ends.

usage: range_server.py FOLDER [CERTIFICATES]; with the second, the Python needs `cryptography`
"""
import datetime
import hashlib
import http.server
import ipaddress
import pathlib
import re
import ssl
import sys
import threading


class RangeHandler(http.server.BaseHTTPRequestHandler):
    """Sends one range of a file, which every request must ask for."""

    protocol_version = "HTTP/1.1"
    folder: pathlib.Path

    def do_GET(self):
        path = self.folder / self.path.lstrip("/")
        asked = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if not path.is_file() or not asked:
            return self.answer(404 if asked else 400, b"")
        content = path.read_bytes()
        first, last = int(asked[1]), min(int(asked[2]), len(content) - 1)
        if first > last:
            return self.answer(416, b"")
        tag = hashlib.sha256(content).hexdigest()[:16]
        headers = {"Content-Range": f"bytes {first}-{last}/{len(content)}", "ETag": f'"{tag}"'}
        return self.answer(206, content[first:last + 1], headers)

    def answer(self, status, body, headers=None):
        self.send_response(status)
        for name, value in {**(headers or {}), "Content-Length": len(body)}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


def authority(name):
    """The key of an authority and its certificate."""
    from cryptography import x509
    from cryptography.hazmat.primitives.asymmetric import ec

    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, name)])
    constraints = x509.BasicConstraints(ca=True, path_length=None)
    return key, signed(key, subject, key, subject, [(constraints, True)])


def signed(signer, issuer, key, subject, extensions):
    """The certificate of a key, valid for two days."""
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes

    now = datetime.datetime.now(datetime.timezone.utc)
    day = datetime.timedelta(days=1)
    builder = x509.CertificateBuilder(issuer, subject, key.public_key(), x509.random_serial_number(), now - day, now + day)
    for extension, critical in extensions:
        builder = builder.add_extension(extension, critical)
    return builder.sign(signer, hashes.SHA256())


def encryption(folder):
    """The TLS of a server at 127.0.0.1; its authority and another are written to a folder."""
    from cryptography import x509
    from cryptography.hazmat.primitives import serialization
    from cryptography.hazmat.primitives.asymmetric import ec

    pem = serialization.Encoding.PEM
    for name in ["stranger", "authority"]:
        signer, certificate = authority(name)
        (folder / f"{name}.pem").write_bytes(certificate.public_bytes(pem))
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "server")])
    names = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address("127.0.0.1"))])
    own = signed(signer, certificate.subject, key, subject, [(names, False)])
    plain = key.private_bytes(pem, serialization.PrivateFormat.PKCS8, serialization.NoEncryption())
    (folder / "server.pem").write_bytes(plain + own.public_bytes(pem))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(folder / "server.pem")
    return context


class EncryptingServer(http.server.ThreadingHTTPServer):
    """Encrypts in the thread of a connection, so that one that fails leaves the others alone."""

    context = None

    def finish_request(self, request, client_address):
        if self.context:
            try:
                request = self.context.wrap_socket(request, server_side=True)
            except OSError:
                return
        super().finish_request(request, client_address)

    def handle_error(self, request, client_address):
        """A client that breaks off is none."""


if __name__ == "__main__":
    RangeHandler.folder = pathlib.Path(sys.argv[1])
    server = EncryptingServer(("127.0.0.1", 0), RangeHandler)
    if len(sys.argv) > 2:
        server.context = encryption(pathlib.Path(sys.argv[2]))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print(f"127.0.0.1:{server.server_port}", flush=True)
    sys.stdin.read()
