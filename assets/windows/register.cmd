@echo off
rem Tells Windows, for the current user only, that this Focus Brush opens its kinds of files.
rem Run it again after moving the folder; unregister.cmd takes it back.
setlocal
set "PROGRAM=%~dp0focus-brush-window.exe"
set "CLASSES=HKCU\Software\Classes"

reg add "%CLASSES%\FocusBrush.Project" /ve /d "Focus Brush project" /f >nul
reg add "%CLASSES%\FocusBrush.Project\DefaultIcon" /ve /d "%PROGRAM%,0" /f >nul
reg add "%CLASSES%\FocusBrush.Project\shell\open\command" /ve /d "\"%PROGRAM%\" \"%%1\"" /f >nul
reg add "%CLASSES%\.fbrush" /ve /d "FocusBrush.Project" /f >nul

reg add "%CLASSES%\FocusBrush.Scene" /ve /d "3D scene" /f >nul
reg add "%CLASSES%\FocusBrush.Scene\DefaultIcon" /ve /d "%PROGRAM%,0" /f >nul
reg add "%CLASSES%\FocusBrush.Scene\shell\open\command" /ve /d "\"%PROGRAM%\" \"%%1\"" /f >nul
rem Scenes keep the program that opens them; Focus Brush is offered under "Open with".
reg add "%CLASSES%\.glb\OpenWithProgids" /v "FocusBrush.Scene" /d "" /f >nul
reg add "%CLASSES%\.gltf\OpenWithProgids" /v "FocusBrush.Scene" /d "" /f >nul

reg query "%CLASSES%\.fbrush" >nul
if errorlevel 1 goto failed
echo Projects (.fbrush) now open with "%PROGRAM%".
exit /b 0

:failed
echo The registry could not be written to.
exit /b 1
