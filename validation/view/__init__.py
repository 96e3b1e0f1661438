"""A scene as a reader sees it: closed-form check, drawings, animation, HTML scene."""
