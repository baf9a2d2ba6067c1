@echo off
rem Takes back what register.cmd did, for the current user.
setlocal
set "CLASSES=HKCU\Software\Classes"
reg delete "%CLASSES%\FocusBrush.Project" /f >nul 2>nul
reg delete "%CLASSES%\FocusBrush.Scene" /f >nul 2>nul
reg delete "%CLASSES%\.fbrush" /f >nul 2>nul
reg delete "%CLASSES%\.glb\OpenWithProgids" /v "FocusBrush.Scene" /f >nul 2>nul
reg delete "%CLASSES%\.gltf\OpenWithProgids" /v "FocusBrush.Scene" /f >nul 2>nul
echo Focus Brush opens no kinds of files any more.
